#pragma once

namespace frana {

/// Has VTK loop in the thread that calls it. Files and pictures are made side by side as it is. VTK's own threads, a few
/// for each short loop, take a twentieth of a run's time to wake up and fall asleep.
void keep_vtk_to_one_thread();

}  // namespace frana
