#pragma once
// Arrays as files hold them: which number type, which component names, and never a value that is not finite.
// One text for every writer, so that VTK and XDMF files of a run agree to the last bit.
#include <cstdint>
#include <string>
#include <vector>

#include "observe/frame.h"

namespace frana {

/// Number type of an array in a file.
enum class Storage { float32, float64, int64 };

/// float64 for what is added up (mass, volume) and for positions (map coordinates need 10 digits). int64 for `id`,
/// float32 (7 digits) for the rest.
Storage storage_of(const Field& field);

/// Names of the components: x, y, z of a vector; xx, yy, xy of a stress. In 3D: xx, yy, zz, xy, yz, xz. Empty for a
/// scalar.
std::vector<std::string> component_names(const Field& field);

/// 1 where a node has no terrain (its "elevation" is NaN), 0 elsewhere. Empty when every node has terrain or the frame
/// has no "elevation". grid.size() entries otherwise.
std::vector<std::uint8_t> outside_nodes(const Frame& frame);

/// Copies an array into `target` (count * components numbers) in the file's number type T (float, double,
/// int64). Where `outside` is 1, a NaN becomes the array's smallest value (scalar) or zero (vector). So no NaN reaches
/// a file and no colour range is spoilt. `outside` is empty for particles. Throws NumericsError for any other number
/// that T cannot hold (NaN, infinite, beyond the range of float32).
template <class T>
void copy_array(const Field& field, const std::vector<std::uint8_t>& outside, T* target);

}  // namespace frana
