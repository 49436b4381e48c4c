// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDHover.h"

#include "pqFFDServerCheck.h"

#include "vtkSMFFDVolumeRepresentationProxy.h"

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqServerManagerModel.h"
#include "pqView.h"

#include "vtkMath.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"

#include <QApplication>
#include <QMainWindow>
#include <QMouseEvent>
#include <QStatusBar>
#include <QTimer>
#include <QToolTip>
#include <QWidget>

#include <string>

namespace
{

/// For how long the pointer is to rest, milliseconds.
constexpr int RestingTime = 400;

QString ToText(const double place[3])
{
  return QString("(%1, %2, %3)")
    .arg(place[0], 0, 'g', 5)
    .arg(place[1], 0, 'g', 5)
    .arg(place[2], 0, 'g', 5);
}

/// The place in the scene of a pixel, at the near (0) or far (1) plane.
void FindPlace(vtkRenderer* renderer, const double pixel[2], double depth, double place[3])
{
  renderer->SetDisplayPoint(pixel[0], pixel[1], depth);
  renderer->DisplayToWorld();
  const double* world = renderer->GetWorldPoint();
  for (int a = 0; a < 3; ++a)
  {
    place[a] = world[a] / world[3];
  }
}

/// What is seen at a pixel of a view of volumes with lattices and their surfaces; empty if nothing
/// is.
QString Describe(vtkSMRenderViewProxy* view, const double pixel[2])
{
  double from[3];
  double to[3];
  FindPlace(view->GetRenderer(), pixel, 0.0, from);
  FindPlace(view->GetRenderer(), pixel, 1.0, to);
  QString text;
  double nearest = VTK_DOUBLE_MAX;
  double shown[3];
  double rest[3];
  double value = 0.0;
  const auto take = [&](const std::string& array) {
    const double distance = vtkMath::Distance2BetweenPoints(from, shown);
    if (distance < nearest)
    {
      nearest = distance;
      text = QObject::tr("deformed: %1\nat rest: %2").arg(ToText(shown), ToText(rest));
      if (!array.empty())
      {
        text = QString("%1: %2\n").arg(QString::fromStdString(array)).arg(value, 0, 'g', 6) + text;
      }
    }
  };
  const vtkSMPropertyHelper all(view, "Representations");
  for (unsigned int i = 0; i < all.GetNumberOfElements(); ++i)
  {
    vtkSMProxy* each = all.GetAsProxy(i);
    vtkSMProperty* own = each ? each->GetProperty("FFDSampleDistance") : nullptr;
    auto* volume =
      vtkSMFFDVolumeRepresentationProxy::SafeDownCast(own ? own->GetParent() : nullptr);
    if (volume && volume->Pick(from, to, shown, rest, value))
    {
      take(volume->GetShownArray());
    }
  }
  const int whole[2] = { static_cast<int>(pixel[0]), static_cast<int>(pixel[1]) };
  std::string array;
  if (vtkSMFFDVolumeRepresentationProxy::PickSurface(view, whole, shown, rest, array, value))
  {
    take(array);
  }
  return text;
}

} // namespace

//------------------------------------------------------------------------------
pqFFDHover::pqFFDHover(QObject* parentObject)
  : QObject(parentObject)
  , Resting(new QTimer(this))
{
  this->Resting->setSingleShot(true);
  this->Resting->setInterval(RestingTime);
  QObject::connect(this->Resting, SIGNAL(timeout()), this, SLOT(show()));
}

//------------------------------------------------------------------------------
pqFFDHover::~pqFFDHover() { this->shutdown(); }

//------------------------------------------------------------------------------
void pqFFDHover::startup()
{
  if (pqApplicationCore::instance())
  {
    qApp->installEventFilter(this);
  }
}

//------------------------------------------------------------------------------
void pqFFDHover::shutdown()
{
  this->Resting->stop();
  if (qApp)
  {
    qApp->removeEventFilter(this);
  }
}

//------------------------------------------------------------------------------
bool pqFFDHover::eventFilter(QObject* watched, QEvent* event)
{
  switch (event->type())
  {
    case QEvent::MouseMove:
    {
      auto* widget = qobject_cast<QWidget*>(watched);
      const auto* move = static_cast<QMouseEvent*>(event);
      if (widget && move->buttons() == Qt::NoButton)
      {
        this->Widget = widget;
        this->Place = move->pos();
        this->Resting->start();
      }
      break;
    }
    case QEvent::MouseButtonPress:
    case QEvent::Wheel:
      this->Resting->stop();
      break;
    case QEvent::Leave:
      this->Resting->stop();
      if (watched == this->Widget)
      {
        this->tell(QString());
      }
      break;
    default:
      break;
  }
  return this->QObject::eventFilter(watched, event);
}

//------------------------------------------------------------------------------
void pqFFDHover::show()
{
  QString text;
  QWidget* widget = this->Widget;
  for (pqView* view : pqApplicationCore::instance()->getServerManagerModel()->findItems<pqView*>())
  {
    auto* proxy = vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy());
    QWidget* own = view->widget();
    if (widget && proxy && own && (own == widget || own->isAncestorOf(widget)) &&
      !pqFFDServerCheck::isLost(proxy->GetSession()))
    {
      const double ratio = widget->devicePixelRatioF();
      const int* size = proxy->GetRenderWindow()->GetSize();
      const double pixel[2] = { ratio * this->Place.x(), size[1] - 1 - ratio * this->Place.y() };
      text = Describe(proxy, pixel);
    }
  }
  // One of ParaView's, of the cell or point below the pointer, stays: the user has asked for it.
  const bool isOther = QToolTip::isVisible() && QToolTip::text() != this->Shown;
  if (!text.isEmpty() && !isOther)
  {
    QToolTip::showText(widget->mapToGlobal(this->Place), text, widget);
    this->Shown = text;
  }
  this->tell(text.replace("\n", "; "));
}

//------------------------------------------------------------------------------
void pqFFDHover::tell(const QString& text)
{
  auto* window = qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget());
  QStatusBar* bar = window ? window->statusBar() : nullptr;
  if (bar && (!text.isEmpty() || (!this->Told.isEmpty() && bar->currentMessage() == this->Told)))
  {
    bar->showMessage(text);
  }
  this->Told = text;
}
