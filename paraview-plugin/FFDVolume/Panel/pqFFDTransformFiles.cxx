// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDTransformFiles.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPipelineFilter.h"
#include "pqPipelineSource.h"
#include "pqServer.h"

#include "vtkPVDataInformation.h"
#include "vtkSMProxy.h"

#include <QList>
#include <QMap>
#include <QString>
#include <QStringList>

#include <cstring>

namespace
{

bool IsTransformReader(pqPipelineSource* source)
{
  const char* name = source && source->getProxy() ? source->getProxy()->GetXMLName() : nullptr;
  return name && std::strcmp(name, "FFDTransformReader") == 0;
}

/// Why transforms cannot be applied to a source; empty if they can.
QString FindProblem(pqPipelineSource* source)
{
  pqOutputPort* port = source->getNumberOfOutputPorts() > 0 ? source->getOutputPort(0) : nullptr;
  vtkPVDataInformation* data = port ? port->getDataInformation() : nullptr;
  if (!data || data->IsNull())
  {
    return QObject::tr("it has no data");
  }
  return data->DataSetTypeIsA("vtkImageData") && !data->IsCompositeDataSet()
    ? QString()
    : QObject::tr("it is no volume (an image), but \"%1\"").arg(data->GetPrettyDataTypeString());
}

/// The nearest one that a source is made from; null if there is none.
pqPipelineSource* FindVolumeAbove(pqPipelineSource* source)
{
  QList<pqPipelineSource*> seen{ source };
  for (int i = 0; i < seen.size(); ++i)
  {
    if (FindProblem(seen[i]).isEmpty())
    {
      return seen[i];
    }
    auto* filter = qobject_cast<pqPipelineFilter*>(seen[i]);
    const QList<pqOutputPort*> inputs = filter ? filter->getAllInputs() : QList<pqOutputPort*>();
    for (pqOutputPort* input : inputs)
    {
      if (!seen.contains(input->getSource()))
      {
        seen << input->getSource();
      }
    }
  }
  return nullptr;
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
    SLOT(applyToVolume(pqPipelineSource*, const QStringList&)));
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
void pqFFDTransformFiles::applyToVolume(pqPipelineSource* reader, const QStringList& files)
{
  if (!IsTransformReader(reader) || !this->Volume)
  {
    return;
  }
  const bool elsewhere = this->Volume->getServer() != reader->getServer();
  const QString problem = elsewhere ? tr("it is on another server") : FindProblem(this->Volume);
  if (!problem.isEmpty())
  {
    pqPipelineSource* above = elsewhere ? nullptr : FindVolumeAbove(this->Volume);
    const QString text = tr(
      "%1 is opened, but not applied to %2, which is selected: %3. Select %4, and choose Filters > "
      "FFD > FFD Apply Transform with %5 as the transform.")
                           .arg(files.isEmpty() ? reader->getSMName() : files.first(),
                             this->Volume->getSMName(), problem,
                             above         ? above->getSMName()
                               : elsewhere ? tr("a volume of the server that has the file")
                                           : tr("a volume"),
                             reader->getSMName());
    vtkWarningWithObjectMacro(reader->getProxy(), << text.toUtf8().constData());
    return;
  }
  QMap<QString, QList<pqOutputPort*>> inputs;
  inputs["Input"].push_back(this->Volume->getOutputPort(0));
  inputs["Transform"].push_back(reader->getOutputPort(0));
  pqApplicationCore::instance()->getObjectBuilder()->createFilter(
    "filters", "FFDApplyTransform", inputs, reader->getServer());
}
