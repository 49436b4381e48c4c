// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDServerFrames.h"

#include "vtkByteSwap.h"
#include "vtkClientSocket.h"
#include "vtkCompositeMultiProcessController.h"
#include "vtkMultiProcessController.h"
#include "vtkProcessModule.h"
#include "vtkPVSession.h"
#include "vtkSocketCommunicator.h"
#include "vtkWeakPointer.h"

#if VTK_MODULE_ENABLE_VTK_ParallelMPI
#include "vtkMPIController.h"
#define FFD_HAS_MPI
#endif

#include <chrono>
#include <thread>

#ifndef _WIN32
#include <sys/socket.h>
#endif

namespace
{

/// Of the message that asks for an abort; ParaView's own are below 200000.
constexpr int AbortTag = 7100017;

#ifdef FFD_HAS_MPI

/// Of the messages within a group: from the root that the frame is aborted, and to it that a part
/// has ended. MPI's tags go up to 32767.
constexpr int GroupAbortTag = 17017;
constexpr int PartEndTag = 17018;

/// Between looks whether the others have ended their parts.
constexpr auto Pause = std::chrono::milliseconds(2);

#endif

bool IsRendering = false; // this process's part of a frame of the group
int IsAborted = 0;        // the frame in progress; for MPI a number

vtkMultiProcessController* GetRenderServer(vtkPVSession* session)
{
  return session ? session->GetController(vtkPVSession::RENDER_SERVER_ROOT) : nullptr;
}

/// Whether the client asks for an abort, or is gone.
bool HasAbortMessage(vtkMultiProcessController* client)
{
#ifndef _WIN32
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
  (void)client;
#endif
  return false;
}

#ifdef FFD_HAS_MPI

/// The processes of this server, if there are several.
vtkMPIController* GetGroup()
{
  const auto type = vtkProcessModule::GetProcessType();
  auto* all = vtkMPIController::SafeDownCast(vtkMultiProcessController::GetGlobalController());
  const bool isServer =
    type == vtkProcessModule::PROCESS_SERVER || type == vtkProcessModule::PROCESS_RENDER_SERVER;
  return isServer && all && all->GetNumberOfProcesses() > 1 ? all : nullptr;
}

bool HasArrived(vtkMPIController* group, int from, int tag)
{
  int flag = 0;
  int source = 0;
  return group->Iprobe(from, tag, &flag, &source) && flag;
}

#endif

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
  vtkMultiProcessController* client =
    session ? session->GetController(vtkPVSession::CLIENT) : nullptr;
#ifdef FFD_HAS_MPI
  if (vtkMPIController* group = GetGroup())
  {
    if (!IsRendering || IsAborted)
    {
      return IsRendering;
    }
    if (group->GetLocalProcessId() == 0)
    {
      IsAborted = HasAbortMessage(client) ? 1 : 0;
      for (int other = 1; IsAborted && other < group->GetNumberOfProcesses(); ++other)
      {
        group->Send(&IsAborted, 1, other, GroupAbortTag);
      }
    }
    else if (HasArrived(group, 0, GroupAbortTag))
    {
      group->Receive(&IsAborted, 1, 0, GroupAbortTag);
    }
    return IsAborted != 0;
  }
#endif
  return HasAbortMessage(client);
}

bool IsGroup()
{
#ifdef FFD_HAS_MPI
  return GetGroup() != nullptr;
#else
  return false;
#endif
}

void BeginPart()
{
  IsRendering = true;
  IsAborted = 0;
}

void EndPart(const std::function<void()>& wait)
{
#ifdef FFD_HAS_MPI
  if (vtkMPIController* group = GetGroup())
  {
    int ended = 1;
    if (group->GetLocalProcessId() != 0)
    {
      group->Send(&ended, 1, 0, PartEndTag);
    }
    else
    {
      while (ended < group->GetNumberOfProcesses())
      {
        if (HasArrived(group, vtkMultiProcessController::ANY_SOURCE, PartEndTag))
        {
          int one = 0;
          group->Receive(&one, 1, vtkMultiProcessController::ANY_SOURCE, PartEndTag);
          ended += one;
          continue;
        }
        wait();
        std::this_thread::sleep_for(Pause);
      }
    }
    // No request stays for a later frame.
    int isAborted = IsAborted;
    group->Broadcast(&isAborted, 1, 0);
    if (isAborted && !IsAborted)
    {
      group->Receive(&isAborted, 1, 0, GroupAbortTag);
    }
  }
#else
  (void)wait;
#endif
  IsRendering = false;
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
