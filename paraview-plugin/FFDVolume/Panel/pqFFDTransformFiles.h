// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDTransformFiles_h
#define pqFFDTransformFiles_h

#include <QObject>
#include <QPointer>

class pqPipelineSource;

/**
 * Applies transform files to a volume when they are opened: File > Open, with an image selected in
 * the pipeline browser, makes "FFD Apply Transform" of both, which Apply then shows. With anything
 * else selected a warning says that nothing is applied, and what to do.
 */
class pqFFDTransformFiles : public QObject
{
  Q_OBJECT

public:
  pqFFDTransformFiles(QObject* parent = nullptr);
  ~pqFFDTransformFiles() override;

  /// Called by ParaView when the plugin is loaded and unloaded.
  void startup();
  void shutdown();

private Q_SLOTS:
  void noteActive(pqPipelineSource* source);
  void applyToVolume(pqPipelineSource* reader, const QStringList& files);

private:
  Q_DISABLE_COPY(pqFFDTransformFiles)

  QPointer<pqPipelineSource> Volume; // selected last, whatever it is
};

#endif
