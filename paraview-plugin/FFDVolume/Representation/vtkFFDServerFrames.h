// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDServerFrames.h
 * Abortion of a server's frame by the ParaView client. Private to the plugin.
 *
 * While the server renders, the client waits for the picture; messages of progress are the only
 * ones that reach it. When one comes, it may send a message that asks for an abort. The server
 * looks for it now and then during the frame, without taking it from the connection, where it is
 * followed by nothing that belongs to the frame. It is taken, and does nothing, when the server
 * waits for the next request.
 *
 * Of a server of several processes, a group, only the root is connected to the client: it passes
 * the request on to the others, which look for it as the root does. The root waits for their parts
 * with an eye on its client, for a process that waits within MPI sees nothing.
 */
#ifndef vtkFFDServerFrames_h
#define vtkFFDServerFrames_h

#include "vtkFFDParaViewModule.h" // For export macro

#include <functional>

class vtkPVSession;

namespace ffdserver
{

/// On the root of a server that renders: to be called before its client can ask for an abort.
void Listen(vtkPVSession* session);

/// On a process of a server that renders: whether its client has asked for an abort of this frame,
/// or is gone. In a group: between BeginPart() and EndPart() only; `session` may be null but on the
/// root.
bool IsAbortAsked(vtkPVSession* session);

/// Whether several processes of a server render together.
bool IsGroup();

/// In a group, on all processes: begin this one's part of a frame.
void BeginPart();

/// In a group, on all processes: end it. The root returns when all have ended theirs, and calls
/// `wait` until then, which has to look whether an abort is asked for; the others may return later
/// than the root.
void EndPart(const std::function<void()>& wait);

/// Whether a server renders for this client.
VTKFFDPARAVIEW_EXPORT bool HasRenderServer(vtkPVSession* session);

/// On a client, while it waits for the picture of the server.
VTKFFDPARAVIEW_EXPORT void AskForAbort(vtkPVSession* session);

} // namespace ffdserver

#endif
