#pragma once
// The steps of build_scene, one subject each. Private to this room and its tests.
#include <optional>
#include <string>
#include <vector>

#include "particles/release.h"
#include "scene/build_scene.h"
#include "scene/case_file.h"
#include "scene/lines_of_case.h"
#include "scene/problems.h"
#include "scene/scene.h"
#include "scene/toolbox.h"

namespace frana {

/// Which nodes of a grid hold (or touch) material; geometry.size() entries, 1 or 0, order as in Raster.
using NodeMarks = std::vector<char>;

/// Laws, scheme, boundary, time and output of the case; no files are read.
void set_physics(const CaseFile& file, Scene& scene);

/// Whether the case takes friction from a table of classes.
bool friction_by_table(const CaseFile& file);
/// The keys of laws' numbers that the case gives rasters for: of the bed law, the rheology and water.friction.
std::vector<std::string> rasters_of_laws(const CaseFile& file);
/// Whether the case has such a table, zones of friction or rasters of it.
bool friction_differs(const CaseFile& file);
/// Reads the table (`released` [m3] tells the class of size), rasters of laws' numbers, and all [[material.zone]]. The
/// scene has its terrain and its laws. What is wrong with them goes to `problems`, remarks to the scene's log. Where
/// nothing varies spatially it does nothing.
void read_friction(const CaseFile& file, const GisReader& reader, double released, Scene& scene, Problems& problems);

/// Whether a line, or a point of it, lies within xmin, ymin, xmax, ymax: its vertices may all lie beyond.
bool comes_onto(const Polyline& line, const std::array<double, 4>& extent);

/// Remarks on a terrain that may not be what was meant, on the material's numbers, and on releases. These have their
/// particles. The remarks go to the scene's log.
void remark_on_terrain(const CaseFile& file, Scene& scene);
void remark_on_material(const CaseFile& file, Scene& scene);
/// The same remarks on friction by rasters, of their least and their largest value on the ground. The scene has its
/// friction.
void remark_on_friction_rasters(const CaseFile& file, Scene& scene);
/// A remark where the class of size that a case gives for its snow is not that of the volume. `released`: by all releases
/// [m3]; the scene has its inflows.
void remark_on_size(const CaseFile& file, double released, Scene& scene);
/// A remark on each field of the output that no frame of this case has.
void remark_on_fields(const CaseFile& file, Scene& scene);
void remark_on_releases(const CaseFile& file, const std::vector<ReleaseSummary>& releases, Scene& scene);
/// A remark on a speed of [[release]] number `i` that no mass has.
void remark_on_speed(const CaseFile& file, Index i, const Release& release, Scene& scene);
/// A remark on a footprint depth that no release has, where nothing else can become deeper.
void remark_on_footprint_depth(const CaseFile& file, const std::vector<ReleaseSummary>& releases, Scene& scene);
/// A remark on each two [[release]] that enter at the same time where they overlap: their depths add up there.
void remark_on_overlaps(const CaseFile& file, const std::vector<Release>& all,
                        const std::vector<ReleaseSummary>& summaries, Scene& scene);
/// A remark on the pixels without data where a release claims material.
void remark_on_gaps(const Raster& field, const NodeMarks& claimed, const std::string& place,
                    std::vector<std::string>& log);

/// [[release]] number `i` of a scene that has its terrain, in the terms of the particle generation. The depth is
/// vertical, rasters are read, and the outline is read and within the terrain. A pixel that is material by outline or
/// mask, but over nodata of the bed, has infinite depth. Outlines with depths of their own (depth = "field:NAME") are a
/// release for each depth; otherwise it is one. What is wrong with its files goes to `problems`, and nothing comes
/// back; remarks go to the scene's log.
std::vector<Release> read_release(const CaseFile& file, Index i, Scene& scene, const GisReader& reader,
                                  Problems& problems);

/// All [[barrier]] of a scene that has its terrain and its stages. What is wrong with their files or their place goes to
/// `problems`.
void read_barriers(const CaseFile& file, const GisReader& reader, const MeshReader& meshes, Scene& scene,
                   Problems& problems);

/// [survey] of a scene that has its terrain: the footprint is read, other files are tried. What is wrong with them goes to
/// `problems`.
void read_survey(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems);

/// How much the ground rises on average to the right of a line, along the line's normals [1].
double rise_across(const Polyline& line, const Raster& bed);
/// All [[section]] of a scene that has its terrain; down the slope of the ground counts as positive.
std::vector<Section> read_sections(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems);
/// Of a scene that has its inflows: those that lie so near to one that they miss some of it.
void remark_on_sections_at_inflows(Scene& scene);

/// All [[inflow]] of a scene that has its terrain and its laws. What is wrong with them goes to `problems`, what they
/// bring to the scene's log.
void read_inflows(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems);

/// Whether a case has free water and nothing else: what it releases is water.
inline bool water_alone(const CaseFile& file) {
    return file.word("water.model") == "free" && file.word("material.structure.law") == "none";
}

/// Friction of free water at the bed, where it is the same everywhere.
WaterFriction water_friction(const CaseFile& file);

/// [material.structure] of a scene that has its terrain and its barriers. What does not fit together goes to `problems`.
std::optional<Structure> read_structure(const CaseFile& file, Scene& scene, Problems& problems);

/// [deposition] of a scene that has its bed law; remarks go to the scene's log.
std::optional<Deposition> read_deposition(const CaseFile& file, Scene& scene);

/// [erodible] of a scene that has its terrain. What is wrong with its files goes to `problems`, remarks to the scene's log.
std::optional<ErodibleBed> read_erodible(const CaseFile& file, const GisReader& reader, Scene& scene,
                                         Problems& problems);

/// [forest] of a scene that has its terrain; nothing where it takes nothing. What is wrong with its files goes to `problems`,
/// remarks to the scene's log.
std::optional<Forest> read_forest(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems);

/// [water] of a scene that has its structure. What does not fit together, or is wrong with its rasters, goes to `problems`,
/// remarks to the scene's log.
std::optional<WaterPhase> read_water(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems);

/// The 3D [[stage]], when the case has one. What does not fit together or the terrain goes to `problems`.
std::optional<SolidStage> read_solid_stage(const CaseFile& file, const Scene& scene, Problems& problems);

/// All [[insitu]], with their cameras. What does not fit together, the terrain or the rheology goes to `problems`.
std::vector<Insitu> read_insitu(const CaseFile& file, const Scene& scene, Problems& problems);

/// A depth field whose pixels are larger than `cell`, on pixels that are not. It is bilinear between their middles.
/// Each pixel's volume and the material's edge stay as they were. No depth leaves the range of the pixel and its
/// neighbours (after Barth and Jespersen 1989, AIAA 89-0366), so a pixel that is the highest around stays even.
Raster finer_field(const Raster& field, double cell);
/// The same on nodes that are closer than the pixels: the mean over the square of each node, in which pixels without data
/// count as 0. So the volume stays. A node has no data where no pixel below its square has any.
Raster on_closer_nodes(const Raster& field, const GridGeometry& grid);

/// Nodes under a release: those inside the outline or next to its edge, where the depth field has material.
NodeMarks nodes_under(const Release& release, const GridGeometry& grid);

/// Pixels that polygons cover a part of. Those that they meet at an edge or by round-off only are none.
NodeMarks pixels_under(const Polygons& outline, const GridGeometry& pixels);

/// Whether the ground stands at `level` or higher along the whole outline: it cuts through no lake of that level.
bool holds_shore(const Release& release, const Raster& bed, double level);

/// Throws UserError, naming the pixel, when the bed has nodata within `reach` cells of a marked node.
void refuse_nodata(const NodeMarks& marks, const Raster& bed, Index reach);

/// Lowers the bed by the release's depth (mean over each node's pixel). Returns the volume cut out [m^3].
double cut_release(const Release& release, Raster& bed);

/// Finds the holes inside the terrain, with a remark on what they are (boundary.holes).
void find_holes(const CaseFile& file, Scene& scene);
/// How high walls in holes stand above the adjacent ground [m]: so that the surface does not fall towards them. What
/// comes onto them is stopped (shallow/sides.cpp). On flanks that rise by six cells in one a flow gains energy.
double hole_wall_height(const Scene& scene);
/// Makes them walls, when they are to be; of a scene that has its particles. Where the model has no such walls that
/// goes to `problems`.
void wall_holes(const CaseFile& file, Scene& scene, Problems& problems);

/// Gradient at a node by central differences, one-sided next to nodata and at the edge [unit of raster per m].
Vec2 node_gradient(const Raster& raster, Index i, Index j);

}  // namespace frana
