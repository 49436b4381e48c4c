// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDHelp_h
#define pqFFDHelp_h

#include <QObject>

/**
 * Hands ParaView the plugin's help pages, which the "?" of the properties panel opens. The pages
 * that ParaView makes itself for a plugin need a program of Qt 5.
 */
class pqFFDHelp : public QObject
{
  Q_OBJECT

public:
  pqFFDHelp(QObject* parent = nullptr);
  ~pqFFDHelp() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

private:
  Q_DISABLE_COPY(pqFFDHelp)
};

#endif
