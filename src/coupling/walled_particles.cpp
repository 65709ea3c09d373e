#include "coupling/walled_particles.h"

namespace frana {

WalledParticles::WalledParticles(const Scene& scene, Start start)
    : density_(scene.density), terrain_(std::make_unique<TerrainParticles>(scene, start)), watch_(scene) {
    particles().note_parents();
    if (start == Start::placed) watch_.sample_particles(particles(), density_);
}

std::vector<std::string> WalledParticles::remarks() const {
    std::vector<std::string> all = inner().remarks();
    for (const std::string& remark : watch_.remarks()) all.push_back(remark);
    return all;
}

void WalledParticles::advance(double until) {
    const double before = inner().status().time;
    inner().advance(until);
    if (watch_.is_due(particles(), before, until))
        timed_("barriers", [&] { watch_.sample_particles(particles(), density_); });
}

std::vector<PhaseTime> WalledParticles::timings() const {
    std::vector<PhaseTime> all = inner().timings();
    for (const PhaseTime& phase : timed_.times()) all.push_back(phase);
    return all;
}

void WalledParticles::serialize(Archive& archive) {
    inner().serialize(archive);
    particles().note_parents();  // a larger part is another object
    watch_.serialize(archive);
    const Archive::Part part(archive, "walled_clock");
    timed_.serialize(archive);
}

}  // namespace frana
