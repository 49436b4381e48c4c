// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDServerCheck.h"

#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "pqApplicationCore.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"

#include "vtkCallbackCommand.h"
#include "vtkNew.h"
#include "vtkPVSessionBase.h"
#include "vtkSMSession.h"
#include "vtkWeakPointer.h"

#include <QPointer>
#include <QTimer>

#include <algorithm>
#include <vector>

namespace
{

std::vector<vtkWeakPointer<vtkObject>> Lost;

void NoteLoss(vtkObject* session, unsigned long, void*, void*) { Lost.emplace_back(session); }

} // namespace

//------------------------------------------------------------------------------
pqFFDServerCheck::pqFFDServerCheck(QObject* parentObject)
  : QObject(parentObject)
{
}

//------------------------------------------------------------------------------
pqFFDServerCheck::~pqFFDServerCheck() = default;

//------------------------------------------------------------------------------
void pqFFDServerCheck::startup()
{
  if (!pqApplicationCore::instance())
  {
    return;
  }
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, SIGNAL(serverAdded(pqServer*)), this, SLOT(watch(pqServer*)));
  for (pqServer* server : model->findItems<pqServer*>())
  {
    this->watch(server);
  }
}

//------------------------------------------------------------------------------
void pqFFDServerCheck::shutdown()
{
  if (pqApplicationCore::instance())
  {
    QObject::disconnect(
      pqApplicationCore::instance()->getServerManagerModel(), nullptr, this, nullptr);
  }
}

//------------------------------------------------------------------------------
bool pqFFDServerCheck::isLost(vtkSMSession* session)
{
  return session && std::find(Lost.begin(), Lost.end(), session) != Lost.end();
}

//------------------------------------------------------------------------------
void pqFFDServerCheck::watch(pqServer* server)
{
  if (!server->isRemote())
  {
    return;
  }
  vtkNew<vtkCallbackCommand> note;
  note->SetCallback(&NoteLoss);
  // Before ParaView's own observer, which asks what to do.
  server->session()->AddObserver(vtkPVSessionBase::ConnectionLost, note, 1.0f);
  // ParaView may yet load the plugin there, and then shows which plugins a server lacks.
  const QPointer<pqServer> watched(server);
  QTimer::singleShot(0, this, [watched]() {
    if (watched && !pqFFDServerCheck::isLost(watched->session()))
    {
      vtkSMFFDVolumeRepresentationProxy::CheckServer(watched->session());
    }
  });
}
