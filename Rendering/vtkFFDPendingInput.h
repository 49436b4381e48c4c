// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkFFDPendingInput_h
#define vtkFFDPendingInput_h

class vtkRenderWindow;

/// Whether input to the window waits for its event loop: a mouse button, the wheel or a key, but
/// not a modifier alone. vtkRenderWindow::GetEventPending() leaves keys out under X11; on other
/// systems this is what it says.
bool HasPendingInput(vtkRenderWindow* window);

#endif
