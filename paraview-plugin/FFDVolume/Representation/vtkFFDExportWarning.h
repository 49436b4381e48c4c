// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDExportWarning_h
#define vtkFFDExportWarning_h

class vtkExporter;

namespace ffdexport
{

/// Most scenes that ParaView exports hold surfaces: let an exporter warn of a volume of FFD Volume
/// that is shown and not in its file, or at rest there. ParaView's own volumes are left out without
/// a word.
void Watch(vtkExporter* exporter);

} // namespace ffdexport

#endif
