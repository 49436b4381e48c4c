// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef pqFFDTransformFiles_h
#define pqFFDTransformFiles_h

#include <QObject>
#include <QPointer>

class pqPipelineSource;

/**
 * Applies transform files to a volume when they are opened: File > Open, with an image selected in
 * the pipeline browser, makes "FFD Apply Transform" of both, which Apply then shows.
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
  void applyToVolume(pqPipelineSource* reader);

private:
  Q_DISABLE_COPY(pqFFDTransformFiles)

  QPointer<pqPipelineSource> Volume; // selected last, an image
};

#endif
