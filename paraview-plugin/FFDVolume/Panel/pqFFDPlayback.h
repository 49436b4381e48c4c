// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDPlayback_h
#define pqFFDPlayback_h

#include <QList>
#include <QObject>
#include <QPointer>

class pqFiltersMenuReaction;
class pqProxy;

/**
 * Keeps the filters in toolbars enabled or disabled as they are while ParaView plays. ParaView
 * finds that anew after each update of the active source, and reads the icons of all of them for it
 * and draws the toolbars, which takes a fifth of a frame of a series of 128^3 voxels. Once the
 * player stops, ParaView's timer for it goes off as before.
 */
class pqFFDPlayback : public QObject
{
  Q_OBJECT

public:
  pqFFDPlayback(QObject* parent = nullptr);
  ~pqFFDPlayback() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

  bool eventFilter(QObject* watched, QEvent* event) override;

private Q_SLOTS:
  void watch(pqProxy* proxy);
  void begin();
  void end();

private:
  Q_DISABLE_COPY(pqFFDPlayback)

  QList<QPointer<pqFiltersMenuReaction>> Reactions; // while ParaView plays
};

#endif
