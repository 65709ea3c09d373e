#include "io/xdmf_writer.h"

#include <fmt/core.h>

#include <map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/hdf5_frame.h"
#include "observe/file_arrays.h"

namespace frana {
namespace {

/// NumberType and Precision of a storage type.
std::string number_attributes(Storage storage) {
    switch (storage) {
        case Storage::int64:
            return "NumberType=\"Int\" Precision=\"8\"";
        case Storage::float64:
            return "NumberType=\"Float\" Precision=\"8\"";
        case Storage::float32:
            break;
    }
    return "NumberType=\"Float\" Precision=\"4\"";
}

std::string attribute_text(const std::string& name, int components, const std::string& dimensions,
                           const std::string& numbers, const std::string& place) {
    // A tensor goes as a matrix. XDMF's Tensor6 counts xx, xy, xz, yy, yz, zz; ours is in the file's `components`.
    const char* const type = components == 1 ? "Scalar" : components == 3 ? "Vector" : "Matrix";
    const std::string more = components == 1 ? "" : fmt::format(" {}", components);
    return fmt::format(
        "        <Attribute Name=\"{0}\" AttributeType=\"{1}\" Center=\"Node\">\n"
        "          <DataItem Format=\"HDF\" Dimensions=\"{2}{3}\" {4}>run.h5:/{5}/{0}</DataItem>\n"
        "        </Attribute>\n",
        name, type, dimensions, more, numbers, place);
}

std::string grid_text(const Frame& frame, bool has_outside) {
    // 3DCoRectMesh of one layer: readers put a 2DCoRectMesh into the y-z plane. Order is z, y, x throughout.
    const GridGeometry& grid = frame.grid;
    const std::string place = frame_group(frame.number) + "/grid";
    const std::string dimensions = fmt::format("1 {} {}", grid.ny, grid.nx);
    std::string text = fmt::format(
        "      <Grid Name=\"grid\" GridType=\"Uniform\">\n"
        "        <Time Value=\"{0}\"/>\n"
        "        <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{1}\"/>\n"
        "        <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
        "          <DataItem Format=\"XML\" Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\">0 {2} "
        "{3}</DataItem>\n"
        "          <DataItem Format=\"XML\" Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\">{4} {4} "
        "{4}</DataItem>\n"
        "        </Geometry>\n",
        frame.status.time, dimensions, grid.y0, grid.x0, grid.cell);
    for (const Field& field : frame.nodes)
        text += attribute_text(field.name, field.components, dimensions, number_attributes(storage_of(field)), place);
    if (has_outside) text += attribute_text("outside", 1, dimensions, "NumberType=\"UChar\" Precision=\"1\"", place);
    return text + "      </Grid>\n";
}

std::string particles_text(const Frame& frame) {
    const Index count = frame.particle("position")->count;
    const std::string place = frame_group(frame.number) + "/particles";
    const std::string dimensions = std::to_string(count);
    std::string text = fmt::format(
        "      <Grid Name=\"particles\" GridType=\"Uniform\">\n"
        "        <Time Value=\"{0}\"/>\n"
        "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{1}\" NodesPerElement=\"1\"/>\n"
        "        <Geometry GeometryType=\"XYZ\">\n"
        "          <DataItem Format=\"HDF\" Dimensions=\"{1} 3\" NumberType=\"Float\" Precision=\"8\">"
        "run.h5:/{2}/position</DataItem>\n"
        "        </Geometry>\n",
        frame.status.time, count, place);
    for (const Field& field : frame.particles)
        if (field.name != "position")
            text +=
                attribute_text(field.name, field.components, dimensions, number_attributes(storage_of(field)), place);
    return text + "      </Grid>\n";
}

std::string collection_text(const std::string& name, const std::map<Index, std::string>& grids) {
    std::string text =
        fmt::format("    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n", name);
    for (const auto& [number, grid] : grids) text += grid;
    return text + "    </Grid>\n";
}

class XdmfWriter final : public Observer {
public:
    explicit XdmfWriter(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}

    std::string name() const override { return "xdmf"; }

    void observe(const Frame& frame) override {
        const auto outside = outside_nodes(frame);
        for (const FileExtent& array : append_frame(run_dir_ / "run.h5", grids_.empty(), frame, outside))
            arrays_.push_back(array);
        grids_[frame.number] = grid_text(frame, !outside.empty());
        particles_[frame.number] = particles_text(frame);
        write_list();
    }

    void serialize(Archive& archive) override {
        serialize_texts(archive, "grids", grids_);
        serialize_texts(archive, "particles", particles_);
        if (grids_.empty()) return;
        serialize_file(archive);
        if (archive.loading()) write_list();
    }

private:
    void write_list() const {
        write_text(run_dir_ / "run.xdmf", "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n  <Domain>\n" +
                                              collection_text("grid", grids_) +
                                              collection_text("particles", particles_) + "  </Domain>\n</Xdmf>\n");
    }

    /// HDF5 writes its tables over and over in the same places. A run that is killed there leaves a file that cannot be
    /// opened. So they are stored apart.
    void serialize_file(Archive& archive) {
        const std::filesystem::path file = run_dir_ / "run.h5";
        std::vector<Index> offsets, bytes;
        for (const FileExtent& array : arrays_) {
            offsets.push_back(array.offset);
            bytes.push_back(array.bytes);
        }
        archive.array("offsets", offsets);
        archive.array("bytes", bytes);
        std::vector<std::uint8_t> tables;
        Index length = 0;
        if (!archive.loading()) {
            tables = tables_of(file, arrays_);
            length = static_cast<Index>(std::filesystem::file_size(file));
        }
        archive.array("tables", tables);
        archive.number("length", length);
        if (!archive.loading()) return;
        arrays_.clear();
        for (std::size_t i = 0; i < offsets.size(); ++i) arrays_.push_back({offsets[i], bytes.at(i)});
        put_tables_back(file, length, arrays_, tables);
    }

    static void serialize_texts(Archive& archive, const std::string& name, std::map<Index, std::string>& of_frames) {
        std::vector<Index> numbers;
        std::vector<std::string> texts;
        for (const auto& [number, text] : of_frames) {
            numbers.push_back(number);
            texts.push_back(text);
        }
        archive.array(name + "_numbers", numbers);
        archive.texts(name, texts);
        if (!archive.loading()) return;
        of_frames.clear();
        for (std::size_t i = 0; i < numbers.size(); ++i) of_frames[numbers[i]] = texts.at(i);
    }

    std::filesystem::path run_dir_;
    std::map<Index, std::string> grids_, particles_;  ///< XDMF text of each frame, by number
    std::vector<FileExtent> arrays_;                  ///< of run.h5
};

}  // namespace

std::unique_ptr<Observer> make_xdmf_writer(const std::filesystem::path& run_dir) {
    return std::make_unique<XdmfWriter>(run_dir);
}

}  // namespace frana
