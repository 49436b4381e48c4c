// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDSceneState.h"

#include "vtkActor.h"
#include "vtkActorCollection.h"
#include "vtkCamera.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"
#include "vtkRenderWindow.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"

namespace
{

void AddNumber(const void* owner, int number, vtkFFDSceneState& state)
{
  state.emplace_back(owner, static_cast<vtkMTimeType>(number));
}

/// Add the visible props of a collection.
void AddProps(vtkCollection* props, vtkFFDSceneState& state)
{
  vtkCollectionSimpleIterator at;
  props->InitTraversal(at);
  while (vtkObject* const object = props->GetNextItemAsObject(at))
  {
    vtkProp* const prop = vtkProp::SafeDownCast(object);
    if (prop && prop->GetVisibility())
    {
      state.emplace_back(prop, prop->GetRedrawMTime());
    }
  }
}

} // namespace

//------------------------------------------------------------------------------
void vtkFFDAddView(vtkRenderer* renderer, vtkFFDSceneState& state)
{
  if (renderer->IsActiveCameraCreated())
  {
    vtkCamera* const camera = renderer->GetActiveCamera();
    state.emplace_back(camera, camera->GetMTime());
  }
  vtkLightCollection* const lights = renderer->GetLights();
  vtkCollectionSimpleIterator at;
  lights->InitTraversal(at);
  while (vtkLight* const light = lights->GetNextLight(at))
  {
    state.emplace_back(light, light->GetMTime());
  }
  AddNumber(renderer, renderer->GetTwoSidedLighting(), state);
  AddNumber(renderer, renderer->GetLightFollowCamera(), state);
}

//------------------------------------------------------------------------------
vtkFFDSceneState vtkFFDFindSceneState(vtkRenderWindow* window)
{
  vtkFFDSceneState state;
  const int* const size = window->GetSize();
  AddNumber(window, size[0], state);
  AddNumber(window, size[1], state);
  vtkRendererCollection* const renderers = window->GetRenderers();
  vtkCollectionSimpleIterator at;
  renderers->InitTraversal(at);
  while (vtkRenderer* const renderer = renderers->GetNextRenderer(at))
  {
    state.emplace_back(renderer, renderer->GetMTime());
    vtkFFDAddView(renderer, state);
    // Parts of assemblies and levels of detail are among actors and volumes only.
    AddProps(renderer->GetViewProps(), state);
    AddProps(renderer->GetActors(), state);
    AddProps(renderer->GetVolumes(), state);
  }
  return state;
}
