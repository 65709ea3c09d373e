#pragma once
// The laws of all nodes, laid one over the other: the case's own, classes, rasters, zones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "law/law_map.h"
#include "scene/law_places.h"
#include "scene/nodes_of_place.h"
#include "scene/scene_parts.h"

namespace frana {

/// Of one kind of law, whichever it is.
class LawLayers {
public:
    virtual ~LawLayers() = default;
    /// Whether classes, rasters or zones say something of it.
    virtual bool is_said() const = 0;
    /// A parameter at a node, by its key's name; nothing where the law has none of that name.
    virtual void set(std::size_t node, const std::string& name, double value) = 0;
    /// The pixels at the nodes. What is wrong goes to `problems`.
    virtual void lay_rasters(Problems& problems) = 0;
    /// [[material.zone]] number `zone` on its nodes.
    virtual void lay_zone(Index zone, const NodeMarks& marks) = 0;
    /// Throws UserError unless every node of the ground has all parameters, and they go together.
    virtual void check() const = 0;
    virtual const LawPlace& place() const = 0;
    /// Stores the laws where they belong, their mean in the scene, and the keys of what differs. Beyond the ground
    /// nothing is known and nothing moves, and nodes get the mean.
    virtual void finish(Friction& friction) = 0;
    /// What the nodes of the ground have that are marked with a number, for each parameter that differs somewhere.
    virtual void add_extents(const std::vector<std::uint32_t>& part, std::uint32_t number, FrictionPart& to) const = 0;
};

/// Any: the list of the laws. Law: the one that the case chose.
template <class Any, class Law>
class LayersOf final : public LawLayers {
    using Key = laws::Key<Law>;

public:
    /// Where the laws go, and their mean.
    struct Target {
        laws::LawMap<Any> Friction::*map;
        Any* mean;
    };

    LayersOf(const CaseFile& file, const GisReader& reader, Scene& scene, const LawPlace& place, const Target& target)
        : case_(file),
          reader_(reader),
          scene_(scene),
          place_(place),
          target_(target),
          grid_(scene.bed.geometry),
          keys_(Law::keys()),
          laws_(scene.bed.values.size(), std::get<Law>(*target.mean)) {}

    bool is_said() const override {
        return std::any_of(keys_.begin(), keys_.end(), [&](const Key& key) { return is_said(key.parameter); });
    }

    void set(std::size_t node, const std::string& name, double value) override {
        for (const Key& key : keys_)
            if (name == key.name) laws_[node].*key.parameter = value;
    }

    void lay_rasters(Problems& problems) override {
        for (const Key& key : keys_) {
            const std::string name = place_.table + std::string(key.name);
            if (is_raster(name)) problems.attempt(case_.place(name), [&] { lay_raster(key, name); });
        }
    }

    void lay_zone(Index zone, const NodeMarks& marks) override {
        for (const Key& key : keys_) {
            const std::string name = zone_key(zone, key);
            if (!case_.given(name)) continue;
            const double value = key.convert(case_.number(name));
            for (std::size_t k = 0; k < marks.size(); ++k)
                if (marks[k]) laws_[k].*key.parameter = value;
        }
    }

    void check() const override {
        for (const Key& key : keys_) {
            std::size_t bad = 0, first = 0;
            for (std::size_t k = laws_.size(); k-- > 0;)
                if (is_ground(k) && std::isnan(laws_[k].*key.parameter)) ++bad, first = k;
            if (bad > 0 && is_plain(key)) refuse_gaps(key.name, bad, first);
            if (*key.more_than != '\0') require_more(key);
        }
    }

    const LawPlace& place() const override { return place_; }

    void finish(Friction& friction) override {
        const Law middle = mean();
        for (Law& law : laws_)
            for (const Key& key : keys_)
                if (std::isnan(law.*key.parameter)) law.*key.parameter = middle.*key.parameter;
        friction.*target_.map = laws::law_map<Any>(laws_);
        *target_.mean = middle;
        if (std::is_same_v<Any, Rheology>) take_one_for_all(friction);
        if ((friction.*target_.map).place.empty()) return;
        for (const Key& key : keys_)
            if (is_plain(key) && is_said(key.parameter)) friction.keys.push_back(shown_name(key));
    }

    void add_extents(const std::vector<std::uint32_t>& part, std::uint32_t number, FrictionPart& to) const override {
        for (const Key& key : keys_) {
            if (!is_plain(key) || !is_said(key.parameter)) continue;
            FrictionPart::Extent extent{shown_name(key), key.unit, INFINITY, -INFINITY};
            for (std::size_t k = 0; k < laws_.size(); ++k) {
                if (part[k] != number || !is_ground(k)) continue;
                const double value = laws_[k].*key.parameter;
                extent.low = std::min(extent.low, value), extent.high = std::max(extent.high, value);
            }
            to.extents.push_back(extent);
        }
    }

private:
    bool is_ground(std::size_t k) const { return !std::isnan(scene_.bed.values[k]); }
    Index ground_count() const {
        Index count = 0;
        for (std::size_t k = 0; k < laws_.size(); ++k) count += is_ground(k);
        return count;
    }
    bool is_plain(const Key& key) const { return key.name == laws::plain_name(keys_, key.parameter); }
    bool is_raster(const std::string& key) const { return case_.given(key) && case_.is_text(key); }
    std::string shown_name(const Key& key) const { return place_.in_zone + std::string(key.name); }
    std::string zone_key(Index zone, const Key& key) const {
        return fmt::format("material.zone.{}.{}{}", zone, place_.in_zone, key.name);
    }

    /// Kernels of one rheology and of many agree to round-off alone: they are compiled with fused multiply-adds. Nodes that
    /// all have the same are a run without zones, to the last bit.
    void take_one_for_all(Friction& friction) {
        laws::LawMap<Any>& map = friction.*target_.map;
        const auto& table = std::get<std::vector<Law>>(map.laws);
        if (table.size() != 1) return;
        *target_.mean = table.front();
        map = {};
    }

    /// By any of its keys.
    bool is_said(double Law::*parameter) const {
        if (std::is_same_v<Any, BedLaw> && friction_by_table(case_)) return true;
        for (const Key& key : keys_) {
            if (key.parameter != parameter) continue;
            if (is_raster(place_.table + std::string(key.name))) return true;
            for (Index i = 0; i < case_.count("material.zone"); ++i)
                if (case_.given(zone_key(i, key))) return true;
        }
        return false;
    }

    /// Of the ground's nodes.
    Law mean() const {
        Law law = laws_.front();
        for (const Key& key : keys_) {
            double sum = 0.0, count = 0.0;
            for (std::size_t k = 0; k < laws_.size(); ++k)
                if (is_ground(k)) sum += laws_[k].*key.parameter, count += 1.0;
            law.*key.parameter = sum / count;
        }
        return law;
    }

    /// Of the pixel at each node. Where there is none: the key's default, or NaN.
    void lay_raster(const Key& key, const std::string& name) {
        const std::filesystem::path path = case_.path(name);
        const Raster pixels = pixels_on(path, reader_, scene_);
        require_range(pixels, key.range, path.string());
        Index gaps = 0;
        for (std::size_t k = 0; k < laws_.size(); ++k) {
            const auto node = static_cast<Index>(k);
            const double value = pixel_at(pixels, grid_.x(node % grid_.nx), grid_.y(node / grid_.nx));
            if (!std::isnan(value)) {
                laws_[k].*key.parameter = key.convert(value);
                continue;
            }
            if (is_ground(k)) ++gaps;
            if (key.missing == laws::Missing::refused) laws_[k].*key.parameter = Raster::nodata;
        }
        if (gaps > 0 && key.missing != laws::Missing::refused)
            scene_.log.push_back(fmt::format(
                "{}: {:.3g} % of {} have no data there; they have {:.6g} where no zone says more", case_.place(name),
                100.0 * double(gaps) / double(ground_count()), nodes_text(scene_), Law{}.*key.parameter));
    }

    [[noreturn]] void refuse_gaps(const std::string& key, std::size_t count, std::size_t first) const {
        throw UserError(fmt::format(
            "found no value at {} of {} nodes, such as {}; expected one at each, since {}{} has no default; fill the "
            "gaps of the raster, or give {}{} there by a [[material.zone]]",
            count, ground_count(), place_text(grid_, first), place_.table, key, place_.in_zone, key));
    }

    void require_more(const Key& key) const {
        const auto smaller = std::find_if(keys_.begin(), keys_.end(),
                                          [&](const auto& k) { return std::string(k.name) == key.more_than; });
        for (std::size_t k = 0; k < laws_.size(); ++k) {
            const double value = laws_[k].*key.parameter, other = laws_[k].*(smaller->parameter);
            if (!is_ground(k) || value > other) continue;
            throw UserError(fmt::format("found {} = {:.6g} at {}; expected more than {} = {:.6g} there; {}", key.name,
                                        value, place_text(grid_, k), key.more_than, other, key.way_out));
        }
    }

    const CaseFile& case_;
    const GisReader& reader_;
    Scene& scene_;
    const LawPlace& place_;
    Target target_;
    const GridGeometry& grid_;
    std::vector<Key> keys_;
    std::vector<Law> laws_;  ///< of the nodes; NaN: a parameter that is not known
};

}  // namespace frana
