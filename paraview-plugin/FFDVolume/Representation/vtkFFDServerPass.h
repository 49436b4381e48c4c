// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDServerPass
 * @brief   lets the root of a server see to its client until all processes have drawn their volumes
 *
 * Private to this module. It stands between IceT, which composites the pictures of several
 * processes, and the pass that renders the scene, for one frame: see ffdserver::EndPart(). Without
 * IceT (ParaView without MPI) and with multisampling it is not used.
 *
 * Begin() and Render() have to be called on all processes.
 */
#ifndef vtkFFDServerPass_h
#define vtkFFDServerPass_h

#include "vtkRenderPass.h"

#include <functional>
#include <memory>

class vtkRenderer;

class vtkFFDServerPass : public vtkRenderPass
{
public:
  static vtkFFDServerPass* New();
  vtkTypeMacro(vtkFFDServerPass, vtkRenderPass);

  /// Stand in the way of the renderer's IceT pass until End(), if no other one does already.
  void Begin(vtkRenderer* renderer);
  void End();

  /// Function that the root of a server calls while it waits for the other processes.
  void SetWait(std::function<void()> wait);

  void Render(const vtkRenderState* state) override;

protected:
  vtkFFDServerPass();
  ~vtkFFDServerPass() override;

private:
  vtkFFDServerPass(const vtkFFDServerPass&) = delete;
  void operator=(const vtkFFDServerPass&) = delete;

  struct Place; // where in ParaView's passes this one stands
  std::unique_ptr<Place> Taken;
  std::function<void()> Wait;
};

#endif
