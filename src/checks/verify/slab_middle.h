#pragma once
// The middle of a long slab on a plane, which nothing from its ends has come to yet.
#include "checks/verify/exact_erosion.h"
#include "checks/verify/trial.h"

namespace frana::verify {

/// What the points within two cells of the middle have: speed along the bed and thickness. Also how far along the bed
/// their mean has come.
SlabState middle_of(Trial& trial, double middle, double cosine);

}  // namespace frana::verify
