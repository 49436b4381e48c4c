// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDAtRestMarks_h
#define pqFFDAtRestMarks_h

#include <QList>
#include <QPointer>
#include <QString>
#include <QWidget>

class pqOutputPort;
class pqPipelineBrowserWidget;

/**
 * Draws "at rest" beside names in the pipeline browser, over its rows: ParaView's model of the
 * pipeline has no place for notes of plugins.
 */
class pqFFDAtRestMarks : public QWidget
{
  Q_OBJECT
  /// The names that are marked, as far as their rows are visible, separated by commas.
  Q_PROPERTY(QString marked READ marked)

public:
  struct Mark
  {
    QPointer<pqOutputPort> Port;
    QString Reason; // the tooltip
  };

  explicit pqFFDAtRestMarks(pqPipelineBrowserWidget* browser);

  void setMarks(const QList<Mark>& marks);
  QString marked() const;

  bool eventFilter(QObject* watched, QEvent* event) override;

protected:
  void paintEvent(QPaintEvent* event) override;

private:
  Q_DISABLE_COPY(pqFFDAtRestMarks)

  QRect findPlace(const Mark& mark) const;

  pqPipelineBrowserWidget* Browser; // the parent of the parent
  QList<Mark> Marks;
};

#endif
