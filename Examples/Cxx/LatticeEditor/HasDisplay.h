// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef HasDisplay_h
#define HasDisplay_h

/// Whether a window can be opened. VTK ends the program where X or GLX is missing, so ask before.
bool HasDisplay();

#endif
