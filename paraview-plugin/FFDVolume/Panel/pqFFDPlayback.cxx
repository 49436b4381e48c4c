// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDPlayback.h"

#include "pqAnimationScene.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqFiltersMenuReaction.h"
#include "pqServerManagerModel.h"

#include <QApplication>
#include <QEvent>
#include <QTimer>
#include <QWidget>

#include <algorithm>
#include <cstdint>

namespace
{

/// Whether an object is a member of another one: the timers of ParaView's reactions have no parent
/// to find them by.
template <class Owner>
bool IsMember(const QObject* object, const Owner* owner)
{
  const auto place = reinterpret_cast<std::uintptr_t>(object);
  const auto begin = reinterpret_cast<std::uintptr_t>(owner);
  return owner && place > begin && place < begin + sizeof(Owner);
}

} // namespace

//------------------------------------------------------------------------------
pqFFDPlayback::pqFFDPlayback(QObject* parentObject)
  : QObject(parentObject)
{
}

//------------------------------------------------------------------------------
pqFFDPlayback::~pqFFDPlayback() { this->end(); }

//------------------------------------------------------------------------------
void pqFFDPlayback::startup()
{
  if (!pqApplicationCore::instance())
  {
    return;
  }
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, SIGNAL(proxyAdded(pqProxy*)), this, SLOT(watch(pqProxy*)));
  for (pqAnimationScene* scene : model->findItems<pqAnimationScene*>())
  {
    this->watch(scene);
  }
  // A player whose server is lost does not come to its end.
  QObject::connect(model, SIGNAL(serverRemoved(pqServer*)), this, SLOT(end()));
}

//------------------------------------------------------------------------------
void pqFFDPlayback::shutdown()
{
  if (pqApplicationCore* core = pqApplicationCore::instance())
  {
    pqServerManagerModel* model = core->getServerManagerModel();
    QObject::disconnect(model, nullptr, this, nullptr);
    for (pqAnimationScene* scene : model->findItems<pqAnimationScene*>())
    {
      QObject::disconnect(scene, nullptr, this, nullptr);
    }
  }
  this->end();
}

//------------------------------------------------------------------------------
void pqFFDPlayback::watch(pqProxy* proxy)
{
  if (auto* scene = qobject_cast<pqAnimationScene*>(proxy))
  {
    QObject::connect(
      scene, SIGNAL(beginPlay(vtkObject*, unsigned long, void*, void*)), this, SLOT(begin()));
    QObject::connect(
      scene, SIGNAL(endPlay(vtkObject*, unsigned long, void*, void*)), this, SLOT(end()));
  }
}

//------------------------------------------------------------------------------
void pqFFDPlayback::begin()
{
  const QWidget* window = pqCoreUtilities::mainWidget();
  this->end();
  if (!window)
  {
    return;
  }
  for (pqFiltersMenuReaction* each : window->findChildren<pqFiltersMenuReaction*>())
  {
    this->Reactions << each;
  }
  qApp->installEventFilter(this);
}

//------------------------------------------------------------------------------
void pqFFDPlayback::end()
{
  this->Reactions.clear();
  if (qApp)
  {
    qApp->removeEventFilter(this);
  }
}

//------------------------------------------------------------------------------
/// A timer whose event is kept from it is not stopped by it, and goes off again.
bool pqFFDPlayback::eventFilter(QObject* watched, QEvent* event)
{
  const auto isOwner = [watched](const QPointer<pqFiltersMenuReaction>& reaction) {
    return IsMember(watched, reaction.data());
  };
  return event->type() == QEvent::Timer &&
    std::any_of(this->Reactions.begin(), this->Reactions.end(), isOwner);
}
