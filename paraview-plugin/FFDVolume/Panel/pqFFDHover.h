// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDHover_h
#define pqFFDHover_h

#include <QObject>
#include <QPoint>
#include <QPointer>
#include <QString>

class QTimer;
class QWidget;

/**
 * Tells what the pointer rests on, where that is FFD Volume: the value that is seen first, its
 * place in the scene, and its place at rest, in a tooltip, where ParaView shows none of its own,
 * and in the status bar. The volume is asked, on the server if it is there, once the pointer has
 * not moved for a while and no button is held. The status bar is cleared when the pointer rests
 * beside it, or leaves the view.
 */
class pqFFDHover : public QObject
{
  Q_OBJECT

public:
  pqFFDHover(QObject* parent = nullptr);
  ~pqFFDHover() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

  bool eventFilter(QObject* watched, QEvent* event) override;

private Q_SLOTS:
  void show();

private:
  Q_DISABLE_COPY(pqFFDHover)

  /// Put a text into the status bar; an empty one takes away what this class has put there.
  void tell(const QString& text);

  QTimer* Resting;
  QPointer<QWidget> Widget; // that the pointer is in
  QPoint Place;             // there
  QString Shown;            // what this class has put into the tooltip
  QString Told;             // what this class has put into the status bar
};

#endif
