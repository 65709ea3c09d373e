#pragma once
#include "scene/scene.h"

namespace frana::bench {

/// What structured columns do: deform, yield everywhere and break, are grains from the start, or break together with
/// free water.
enum class ColumnsThat { hold, break_up, are_grains, drain };
const char* name_of(ColumnsThat what);

/// The blob of blob.h of structured columns: without internal rheology and the bed's curvature, which they do not have.
Scene structured_blob(ColumnsThat what, Index particles);

}  // namespace frana::bench
