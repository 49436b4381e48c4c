// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDServerFrames.h"

#include "vtkByteSwap.h"
#include "vtkClientSocket.h"
#include "vtkCompositeMultiProcessController.h"
#include "vtkMultiProcessController.h"
#include "vtkPVSession.h"
#include "vtkSocketCommunicator.h"
#include "vtkWeakPointer.h"

#ifndef _WIN32
#include <sys/socket.h>
#endif

namespace
{

/// Of the message that asks for an abort; ParaView's own are below 200000.
constexpr int AbortTag = 7100017;

vtkMultiProcessController* GetRenderServer(vtkPVSession* session)
{
  return session ? session->GetController(vtkPVSession::RENDER_SERVER_ROOT) : nullptr;
}

} // namespace

namespace ffdserver
{

void Listen(vtkPVSession* session)
{
  static vtkWeakPointer<vtkMultiProcessController> listening;
  vtkMultiProcessController* client = session->GetController(vtkPVSession::CLIENT);
  if (client && listening != client)
  {
    listening = client;
    client->AddRMICallback([](void*, void*, int, int) {}, nullptr, AbortTag);
  }
}

bool IsAbortAsked(vtkPVSession* session)
{
#ifndef _WIN32
  vtkMultiProcessController* client = session->GetController(vtkPVSession::CLIENT);
  if (auto* several = vtkCompositeMultiProcessController::SafeDownCast(client))
  {
    client = several->GetActiveController();
  }
  auto* communicator =
    client ? vtkSocketCommunicator::SafeDownCast(client->GetCommunicator()) : nullptr;
  vtkClientSocket* socket = communicator ? communicator->GetSocket() : nullptr;
  if (socket && socket->GetConnected())
  {
    // The communicator sends tag and length before each message, that of a remote call begins with
    // the tag of what is to be called, in the order of Intel's bytes.
    int message[3] = {};
    const auto size = static_cast<int>(
      recv(socket->GetSocketDescriptor(), message, sizeof(message), MSG_PEEK | MSG_DONTWAIT));
    vtkByteSwap::SwapLE(&message[2]);
    return size == 0 || (size == static_cast<int>(sizeof(message)) && message[2] == AbortTag);
  }
#else
  (void)session;
#endif
  return false;
}

bool HasRenderServer(vtkPVSession* session) { return GetRenderServer(session) != nullptr; }

void AskForAbort(vtkPVSession* session)
{
  if (vtkMultiProcessController* server = GetRenderServer(session))
  {
    server->TriggerRMI(1, AbortTag);
  }
}

} // namespace ffdserver
