// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDServerCheck_h
#define pqFFDServerCheck_h

#include <QObject>

class pqServer;
class vtkSMSession;

/**
 * Says when a server has no plugin, or one of another version, and knows whose connection is lost.
 * ParaView asks whether to save the state of a lost one, and runs timers meanwhile: what they would
 * ask of the server ends ParaView.
 */
class pqFFDServerCheck : public QObject
{
  Q_OBJECT

public:
  pqFFDServerCheck(QObject* parent = nullptr);
  ~pqFFDServerCheck() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

  /// Whether the connection to the server of a session is lost.
  static bool isLost(vtkSMSession* session);

private Q_SLOTS:
  void watch(pqServer* server);

private:
  Q_DISABLE_COPY(pqFFDServerCheck)
};

#endif
