// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// A lattice widget that is dragged by a scripted mouse.
#ifndef FFDBenchmarkWidget_h
#define FFDBenchmarkWidget_h

#include "FFDBenchmarkSuites.h"

#include <memory>
#include <vector>

namespace ffdBenchmark
{

/**
 * Groups WidgetDrag/<opacity>: one control point of 8^3 over the engine is dragged to and fro by
 * events of an interactor, at 512 x 512; a run is one mouse move until the picture is finished.
 * Rows: "full" (full quality), "whole" (the same without FrameCoherence: all rays of every frame),
 * "interactive" (the mapper may adapt to 30 frames a second), "undeformed_drag" (as "whole", with a
 * lattice that deforms nothing), "without_widget" (the same moves of the point without a widget in
 * the scene, full quality), "undeformed" (that scene at rest, drawn again: the least a drag could
 * take). And WidgetDrag/lattice20: 20^3 control points without a volume, straight and curved lines.
 */
void AddWidgetGroups(const Options& options, std::vector<std::unique_ptr<Group>>& groups);

} // namespace ffdBenchmark

#endif
