// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDCompositePass
 * @brief   composites the pictures of several processes where colors are brighter than their alpha
 *
 * Private to this module. IceT blends premultiplied bytes, "front + back * (255 - alpha) / 255",
 * and a sum beyond 255 wraps around to black. Surfaces and absorbing volumes never reach it, for
 * their colors are not brighter than their alpha, but highlights of shaded volumes do.
 *
 * This pass stands between IceT and the pass that renders the scene, for one frame. The volumes are
 * blended into a float texture, which does not clip; if any process has a color brighter than its
 * alpha, the rectangle of such pixels is composited here: each process gets a band of its rows from
 * all others, blends them from back to front in floats as one process would, and returns the result
 * to the process that is foremost at a pixel. The others show nothing there, so IceT adds nothing
 * to it. Everything else is left to IceT.
 *
 * Tiled displays, where processes do not render the same pixels at the same time: alpha is raised
 * to the brightest color. Image processing passes (EDL, tone mapping) have float textures of their
 * own. Without IceT (ParaView without MPI) and with multisampling this pass is not used.
 *
 * On servers of several processes it also lets the root see to its client until all have drawn
 * their volumes.
 *
 * Begin() and Render() have to be called on all processes.
 */
#ifndef vtkFFDCompositePass_h
#define vtkFFDCompositePass_h

#include "vtkRenderPass.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <memory>
#include <vector>

class vtkMultiProcessController;
class vtkOpenGLRenderWindow;
class vtkRenderer;
class vtkTextureObject;

class vtkFFDCompositePass : public vtkRenderPass
{
public:
  static vtkFFDCompositePass* New();
  vtkTypeMacro(vtkFFDCompositePass, vtkRenderPass);

  /**
   * Stand in the way of the renderer's IceT pass until End(). Returns the pass that does: this one,
   * or another one that does already, or null where it cannot be used. `mayBeBright`: a volume may
   * have colors brighter than their alpha.
   */
  vtkFFDCompositePass* Begin(vtkRenderer* renderer, bool mayBeBright);
  void End();

  /**
   * Function that the root of a server calls while it waits for the other processes, see
   * ffdserver::EndPart().
   */
  void SetWait(std::function<void()> wait);

  /**
   * Blends all that is drawn from here on in this frame in floats. To be called before a volume is
   * drawn; without it the picture is that of surfaces.
   */
  void BlendInFloats();

  void Render(const vtkRenderState* state) override;

protected:
  vtkFFDCompositePass();
  ~vtkFFDCompositePass() override;

private:
  vtkFFDCompositePass(const vtkFFDCompositePass&) = delete;
  void operator=(const vtkFFDCompositePass&) = delete;

  struct Rectangle;
  bool FindBright(Rectangle& where) const;
  void CompositeBright();
  bool RaiseAlpha();
  void Composite(const Rectangle& where, std::vector<unsigned char>& bytes) const;

  struct Place; // where in ParaView's passes this one stands
  std::unique_ptr<Place> Taken;
  bool MayBeBright = false;
  std::function<void()> Wait;

  vtkOpenGLRenderWindow* Window = nullptr; // while rendering
  int Size[2] = { 0, 0 };
  std::vector<int> Order;                  // of the processes, front to back
  vtkSmartPointer<vtkTextureObject> Bytes; // of the window, while floats stand in their place
  std::vector<float> Pixels;               // RGBA, premultiplied
};

#endif
