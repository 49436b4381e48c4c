// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDAtRestMarks.h"

#include "pqOutputPort.h"
#include "pqPipelineBrowserWidget.h"
#include "pqPipelineModel.h"
#include "pqPipelineSource.h"

#include <QAbstractProxyModel>
#include <QEvent>
#include <QHelpEvent>
#include <QPainter>
#include <QStringList>
#include <QStyle>
#include <QToolTip>

#include <algorithm>

namespace
{

/// Pixels between the name, the icon and the text.
constexpr int Margin = 4;

QString GetText() { return QObject::tr("at rest"); }

} // namespace

//------------------------------------------------------------------------------
pqFFDAtRestMarks::pqFFDAtRestMarks(pqPipelineBrowserWidget* browser)
  : QWidget(browser->viewport())
  , Browser(browser)
{
  this->setObjectName("FFDAtRestMarks");
  this->setAttribute(Qt::WA_TransparentForMouseEvents);
  this->setAttribute(Qt::WA_NoSystemBackground);
  this->resize(browser->viewport()->size());
  browser->viewport()->installEventFilter(this);
}

//------------------------------------------------------------------------------
void pqFFDAtRestMarks::setMarks(const QList<Mark>& marks)
{
  this->Marks = marks;
  this->setVisible(!marks.isEmpty());
  this->raise();
  this->update();
}

//------------------------------------------------------------------------------
QString pqFFDAtRestMarks::marked() const
{
  QStringList names;
  for (const Mark& mark : this->Marks)
  {
    if (this->isVisible() && this->rect().intersects(this->findPlace(mark)))
    {
      names << mark.Port->getSource()->getSMName();
    }
  }
  return names.join(",");
}

//------------------------------------------------------------------------------
/// Where the icon and the text are; empty if the row is not visible.
QRect pqFFDAtRestMarks::findPlace(const Mark& mark) const
{
  QAbstractItemModel* shown = this->Browser->getModel();
  auto* filter = qobject_cast<QAbstractProxyModel*>(shown);
  auto* pipeline = qobject_cast<pqPipelineModel*>(filter ? filter->sourceModel() : shown);
  if (!pipeline || !mark.Port)
  {
    return {};
  }
  // The only port of a source has no row of its own.
  QModelIndex index = pipeline->getIndexFor(mark.Port);
  index = index.isValid() ? index : pipeline->getIndexFor(mark.Port->getSource());
  index = filter ? filter->mapFromSource(index) : index;
  if (!index.isValid() || this->Browser->isIndexHidden(index))
  {
    return {};
  }
  QRect row;
  this->Browser->getVisibleRect(index, row);
  if (row.isEmpty())
  {
    return {};
  }
  const int icon = this->fontMetrics().height();
  const int width = this->fontMetrics().boundingRect(GetText()).width() + icon + 3 * Margin;
  // In a narrow browser over the end of the name.
  const int left = std::max(0, std::min(row.right() + Margin, this->width() - width));
  return { left, row.top(), width, row.height() };
}

//------------------------------------------------------------------------------
void pqFFDAtRestMarks::paintEvent(QPaintEvent*)
{
  QPainter painter(this);
  for (const Mark& mark : this->Marks)
  {
    const QRect place = this->findPlace(mark);
    if (place.isEmpty())
    {
      continue;
    }
    painter.fillRect(place, this->palette().color(QPalette::ToolTipBase));
    const int size = std::min(place.height(), this->fontMetrics().height());
    const QRect icon(place.left() + Margin, place.center().y() - size / 2, size, size);
    this->style()->standardIcon(QStyle::SP_MessageBoxWarning).paint(&painter, icon);
    painter.setPen(this->palette().color(QPalette::ToolTipText));
    painter.drawText(place.adjusted(size + 2 * Margin, 0, 0, 0), Qt::AlignVCenter, GetText());
  }
}

//------------------------------------------------------------------------------
bool pqFFDAtRestMarks::eventFilter(QObject* watched, QEvent* event)
{
  switch (event->type())
  {
    case QEvent::Resize:
      this->resize(this->Browser->viewport()->size());
      break;
    case QEvent::Paint:
      // What is below may have moved.
      this->update();
      break;
    case QEvent::ToolTip:
    {
      const auto* help = static_cast<QHelpEvent*>(event);
      for (const Mark& mark : this->Marks)
      {
        if (this->findPlace(mark).contains(help->pos()))
        {
          QToolTip::showText(help->globalPos(), mark.Reason, this->Browser);
          return true;
        }
      }
      break;
    }
    default:
      break;
  }
  return this->QWidget::eventFilter(watched, event);
}
