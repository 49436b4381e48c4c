// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pqFFDHelp.h"

#include "pqApplicationCore.h"

#include <QFile>
#include <QHelpEngine>

//------------------------------------------------------------------------------
pqFFDHelp::pqFFDHelp(QObject* parentObject)
  : QObject(parentObject)
{
}

//------------------------------------------------------------------------------
pqFFDHelp::~pqFFDHelp() = default;

//------------------------------------------------------------------------------
void pqFFDHelp::startup()
{
  // Without qhelpgenerator the plugin is built without pages.
  const QString pages = ":/FFDVolume/help/FFDVolume.qch";
  pqApplicationCore* core = pqApplicationCore::instance();
  if (core && QFile::exists(pages))
  {
    // With Qt 6 it takes no pages as ParaView 5.13 leaves it; Qt 5 has no such property.
    core->helpEngine()->setProperty("readOnly", false);
    core->helpEngine()->setupData();
    core->registerDocumentation(pages);
  }
}

//------------------------------------------------------------------------------
void pqFFDHelp::shutdown() {}
