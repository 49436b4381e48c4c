// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDTransformFiles.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPipelineSource.h"

#include "vtkPVDataInformation.h"
#include "vtkSMProxy.h"

#include <QList>
#include <QMap>

#include <cstring>

namespace
{

bool IsTransformReader(pqPipelineSource* source)
{
  const char* name = source && source->getProxy() ? source->getProxy()->GetXMLName() : nullptr;
  return name && std::strcmp(name, "FFDTransformReader") == 0;
}

bool IsImage(pqPipelineSource* source)
{
  pqOutputPort* port =
    source && source->getNumberOfOutputPorts() > 0 ? source->getOutputPort(0) : nullptr;
  vtkPVDataInformation* data = port ? port->getDataInformation() : nullptr;
  return data && data->DataSetTypeIsA("vtkImageData") && !data->IsCompositeDataSet();
}

} // namespace

//------------------------------------------------------------------------------
pqFFDTransformFiles::pqFFDTransformFiles(QObject* parentObject)
  : QObject(parentObject)
{
}

//------------------------------------------------------------------------------
pqFFDTransformFiles::~pqFFDTransformFiles() = default;

//------------------------------------------------------------------------------
void pqFFDTransformFiles::startup()
{
  pqApplicationCore* core = pqApplicationCore::instance();
  if (!core)
  {
    return;
  }
  this->noteActive(pqActiveObjects::instance().activeSource());
  QObject::connect(&pqActiveObjects::instance(), SIGNAL(sourceChanged(pqPipelineSource*)), this,
    SLOT(noteActive(pqPipelineSource*)));
  QObject::connect(core->getObjectBuilder(),
    SIGNAL(readerCreated(pqPipelineSource*, const QStringList&)), this,
    SLOT(applyToVolume(pqPipelineSource*)));
}

//------------------------------------------------------------------------------
void pqFFDTransformFiles::shutdown()
{
  if (pqApplicationCore* core = pqApplicationCore::instance())
  {
    QObject::disconnect(&pqActiveObjects::instance(), nullptr, this, nullptr);
    QObject::disconnect(core->getObjectBuilder(), nullptr, this, nullptr);
  }
}

//------------------------------------------------------------------------------
/// A new reader becomes the active source before it is told of.
void pqFFDTransformFiles::noteActive(pqPipelineSource* source)
{
  if (source && !IsTransformReader(source))
  {
    this->Volume = source;
  }
}

//------------------------------------------------------------------------------
void pqFFDTransformFiles::applyToVolume(pqPipelineSource* reader)
{
  if (!IsTransformReader(reader) || !IsImage(this->Volume) ||
    this->Volume->getServer() != reader->getServer())
  {
    return;
  }
  QMap<QString, QList<pqOutputPort*>> inputs;
  inputs["Input"].push_back(this->Volume->getOutputPort(0));
  inputs["Transform"].push_back(reader->getOutputPort(0));
  pqApplicationCore::instance()->getObjectBuilder()->createFilter(
    "filters", "FFDApplyTransform", inputs, reader->getServer());
}
