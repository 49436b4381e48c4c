// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDAtRest.h"

#include "pqFFDAtRestMarks.h"
#include "pqFFDServerCheck.h"

#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqDataRepresentation.h"
#include "pqOutputPort.h"
#include "pqPipelineBrowserWidget.h"
#include "pqPipelineSource.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "pqView.h"

#include <QLabel>
#include <QMainWindow>
#include <QStatusBar>
#include <QStringList>
#include <QTimer>

//------------------------------------------------------------------------------
pqFFDAtRest::pqFFDAtRest(QObject* parentObject)
  : QObject(parentObject)
  , Soon(new QTimer(this))
{
  this->Soon->setSingleShot(true);
  this->Soon->setInterval(0);
  QObject::connect(this->Soon, SIGNAL(timeout()), this, SLOT(refresh()));
}

//------------------------------------------------------------------------------
pqFFDAtRest::~pqFFDAtRest() = default;

//------------------------------------------------------------------------------
void pqFFDAtRest::startup()
{
  if (!pqApplicationCore::instance())
  {
    return;
  }
  // A window of messages would be in the way.
  vtkSMFFDVolumeRepresentationProxy::SetWarnsOfRest(false);
  pqActiveObjects& active = pqActiveObjects::instance();
  QObject::connect(&active, SIGNAL(viewChanged(pqView*)), this, SLOT(watch(pqView*)));
  QObject::connect(pqApplicationCore::instance()->getServerManagerModel(),
    SIGNAL(sourceRemoved(pqPipelineSource*)), this->Soon, SLOT(start()));
  this->watch(active.activeView());
}

//------------------------------------------------------------------------------
void pqFFDAtRest::shutdown()
{
  this->Soon->stop();
  vtkSMFFDVolumeRepresentationProxy::SetWarnsOfRest(true);
  delete this->Label;
  delete this->Marks;
}

//------------------------------------------------------------------------------
void pqFFDAtRest::watch(pqView* view)
{
  if (this->View)
  {
    QObject::disconnect(this->View, nullptr, this->Soon, nullptr);
  }
  this->View = view;
  if (view)
  {
    // Each change of what is shown ends in a picture.
    QObject::connect(view, SIGNAL(endRender()), this->Soon, SLOT(start()));
    QObject::connect(view, SIGNAL(representationVisibilityChanged(pqRepresentation*, bool)),
      this->Soon, SLOT(start()));
  }
  this->Soon->start();
}

//------------------------------------------------------------------------------
/// The window is made after the plugin is loaded.
void pqFFDAtRest::findWidgets()
{
  auto* window = qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget());
  if (!window)
  {
    return;
  }
  if (!this->Label)
  {
    this->Label = new QLabel(window->statusBar());
    this->Label->setObjectName("FFDAtRest");
    this->Label->hide();
    window->statusBar()->insertPermanentWidget(0, this->Label);
  }
  auto* browser = window->findChild<pqPipelineBrowserWidget*>();
  if (!this->Marks && browser)
  {
    this->Marks = new pqFFDAtRestMarks(browser);
  }
}

//------------------------------------------------------------------------------
void pqFFDAtRest::refresh()
{
  if (this->View && pqFFDServerCheck::isLost(this->View->getServer()->session()))
  {
    return;
  }
  QList<pqFFDAtRestMarks::Mark> marks;
  QStringList told;
  const QList<pqRepresentation*> all =
    this->View ? this->View->getRepresentations() : QList<pqRepresentation*>();
  for (pqRepresentation* each : all)
  {
    auto* data = qobject_cast<pqDataRepresentation*>(each);
    pqOutputPort* port = data && data->isVisible() ? data->getOutputPortFromInput() : nullptr;
    const std::string type =
      port ? vtkSMFFDVolumeRepresentationProxy::FindTypeAtRest(data->getProxy()) : std::string();
    if (!type.empty())
    {
      marks << pqFFDAtRestMarks::Mark{ port,
        QString::fromStdString(vtkSMFFDVolumeRepresentationProxy::ExplainRest(type)) };
      told << tr("%1 is shown at rest (%2)")
                .arg(port->getSource()->getSMName(), QString::fromStdString(type));
    }
  }
  if (!marks.isEmpty())
  {
    this->findWidgets();
  }
  if (this->Marks)
  {
    this->Marks->setMarks(marks);
  }
  if (this->Label)
  {
    this->Label->setText(told.join("; "));
    this->Label->setToolTip(marks.isEmpty() ? QString() : marks.front().Reason);
    this->Label->setVisible(!told.isEmpty());
  }
}
