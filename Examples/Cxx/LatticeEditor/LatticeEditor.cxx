// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Shape a volume by hand: a window with a volume, the lattice that deforms it, and
// vtkFFDLatticeWidget between the two. Usage: LatticeEditor --help; in the window: h.
// Examples/Python/lattice_editor.py is the same in Python.
#include "HasDisplay.h"

#include "vtkFFDInteractiveFrames.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeWidget.h"
#include "vtkFFDVolumePicker.h"
#include "vtkFFDVolumeReader.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageBlend.h"
#include "vtkImageData.h"
#include "vtkImageExtractComponents.h"
#include "vtkImageHistogram.h"
#include "vtkInteractorEventRecorder.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSmartPointer.h"
#include "vtkStringOutputWindow.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkWindowToImageFilter.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLImageDataWriter.h"

#include "vtksys/SystemTools.hxx"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace
{

using Rep = vtkFFDLatticeRepresentation;

const char* const Usage =
  "usage: LatticeEditor [options] [VOLUME]\n"
  "  VOLUME             a .vti file, any image file VTK can read (.mhd, .nii, .nrrd, ...), a\n"
  "                     legacy .vtk file, or a folder of DICOM slices; default: the engine block\n"
  "  --points N         control points per axis, 4 to 64; default 6\n"
  "  --lattice FILE     start with a saved lattice\n"
  "  --size W H         window in pixels; default 1000 800\n"
  "  --play FILE        play recorded events (vtkInteractorEventRecorder), then end\n"
  "  --screenshot FILE  write a picture (.png), then end\n"
  "  --save-lattice FILE  write the lattice (.vti) at the end\n";

const char* const Help = "left        select; shift adds, ctrl toggles\n"
                         "drag        move; from outside with shift/ctrl: region\n"
                         "x y z       along an axis; with shift: across it\n"
                         "g r s       handle: move, turn, scale\n"
                         "a A I       all, none, invert    + - grow, shrink\n"
                         "alt x y z   rows; with shift: planes\n"
                         "o  wheel    soft editing, radius    O falloff\n"
                         "m l v       symmetry, lock, fold guard\n"
                         "d           grab the volume itself; shift-click pins\n"
                         "arrows      nudge; shift far, ctrl fine\n"
                         "Delete      reset selection; shift point, ctrl all\n"
                         "ctrl z y    undo, redo    Escape  cancel\n"
                         "\n"
                         "Tab         before / after\n"
                         "[ ]         show more, less of the volume\n"
                         "c n t       curved lines, labels, lattice on/off\n"
                         "F2          refine the lattice (twice the cells)\n"
                         "F5 F9       save, load the lattice (lattice.vti)\n"
                         "F12         save a picture (picture.png)\n"
                         "h q         help, quit";

//------------------------------------------------------------------------------
/// While it lives, what VTK's readers and writers complain about is collected, not printed.
class Complaints
{
public:
  Complaints()
    : Previous(vtkOutputWindow::GetInstance())
  {
    vtkOutputWindow::SetInstance(this->Window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~Complaints()
  {
    vtkOutputWindow::SetInstance(this->Previous);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_INFO);
  }

  /// The first of them, without where in VTK's sources it comes from; empty: there were none.
  std::string GetFirst() const
  {
    const std::string text = this->Window->GetOutput();
    const std::size_t start = text.find("): ");
    return start == std::string::npos ? text
                                      : text.substr(start + 3, text.find('\n', start) - start - 3);
  }

private:
  vtkSmartPointer<vtkOutputWindow> Previous;
  vtkNew<vtkStringOutputWindow> Window;
};

//------------------------------------------------------------------------------
/// Read a volume; null, with the reason in `problem`, if it cannot be used.
vtkSmartPointer<vtkImageData> ReadVolume(const std::string& path, std::string& problem)
{
  vtkNew<vtkFFDVolumeReader> reader;
  reader->SetFileName(path.c_str());
  {
    const Complaints complaints;
    reader->Update();
  }
  problem = reader->GetProblem();
  if (!problem.empty())
  {
    return nullptr;
  }
  vtkSmartPointer<vtkImageData> image = reader->GetOutput();
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (scalars->GetNumberOfComponents() > 1)
  {
    std::cout << "LatticeEditor: of " << scalars->GetNumberOfComponents()
              << " components the first is shown\n";
    vtkNew<vtkImageExtractComponents> first;
    first->SetInputData(image);
    first->SetComponents(0);
    first->Update();
    image = first->GetOutput();
  }
  return image;
}

//------------------------------------------------------------------------------
/// The scalar that parts the two classes of a histogram best (Otsu 1979), and the useful range.
void FindThreshold(vtkImageData* image, double range[2], double& threshold)
{
  vtkNew<vtkImageHistogram> histogram;
  histogram->SetInputData(image);
  histogram->AutomaticBinningOn();
  histogram->SetMaximumNumberOfBins(1024);
  histogram->GenerateHistogramImageOff();
  histogram->Update();
  vtkIdTypeArray* counts = histogram->GetHistogram();
  const vtkIdType bins = counts->GetNumberOfValues();
  const double width = histogram->GetBinSpacing();
  const double origin = histogram->GetBinOrigin();
  double total = 0.0;
  double sum = 0.0;
  for (vtkIdType b = 0; b < bins; ++b)
  {
    total += static_cast<double>(counts->GetValue(b));
    sum += static_cast<double>(counts->GetValue(b)) * static_cast<double>(b);
  }
  double below = 0.0;
  double sumBelow = 0.0;
  double best = -1.0;
  threshold = origin;
  range[0] = origin;
  range[1] = origin + width * static_cast<double>(bins - 1);
  bool upperFound = false;
  for (vtkIdType b = 0; b < bins; ++b)
  {
    below += static_cast<double>(counts->GetValue(b));
    sumBelow += static_cast<double>(counts->GetValue(b)) * static_cast<double>(b);
    const double above = total - below;
    // A few bright voxels do not stretch the range.
    if (!upperFound && above <= 0.0005 * total)
    {
      range[1] = origin + width * static_cast<double>(b);
      upperFound = true;
    }
    if (below > 0.0 && above > 0.0)
    {
      const double gap = sumBelow / below - (sum - sumBelow) / above;
      const double between = below * above * gap * gap;
      if (between > best)
      {
        best = between;
        threshold = origin + width * (static_cast<double>(b) + 0.5);
      }
    }
  }
  if (!(range[1] > range[0]))
  {
    range[1] = range[0] + 1.0;
  }
  threshold = std::min(std::max(threshold, range[0]), range[1]);
}

//------------------------------------------------------------------------------
class Editor
{
public:
  bool Open(const std::string& volume, int points, const std::string& lattice);
  void Start(int width, int height, bool interactive);
  bool SavePicture(const std::string& path);
  bool SaveVolumePicture(const std::string& path, int width, int height);
  bool SaveLattice(const std::string& path);
  bool LoadLattice(const std::string& path);
  void Play(const std::string& path);
  void Interact()
  {
    this->Interactor->Start();
    this->Frames->SetInteractor(nullptr);
  }
  std::string Problem;

private:
  void SetTransferFunctions();
  bool WritePicture(vtkAlgorithm* picture, const std::string& path);
  void ShowStatus();
  void Say(const std::string& text);
  void Draw() { this->Window->Render(); }
  bool OnKey(const std::string& key);
  static void OnEvent(vtkObject* caller, unsigned long event, void* client, void*);

  vtkSmartPointer<vtkImageData> Image;
  double Range[2] = { 0.0, 1.0 };
  double Threshold = 0.5;
  vtkNew<vtkFFDLattice> Lattice;
  vtkNew<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkNew<vtkVolumeProperty> Property;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderWindowInteractor> Interactor;
  vtkNew<vtkFFDInteractiveFrames> Frames;
  vtkNew<vtkFFDLatticeWidget> Widget;
  vtkNew<vtkFFDVolumePicker> Picker;
  vtkNew<vtkTextActor> Status;
  vtkNew<vtkTextActor> HelpText;
  vtkNew<vtkCallbackCommand> Command;
  std::string Message;
  bool Before = false;
  bool UsedKey = false;
};

//------------------------------------------------------------------------------
bool Editor::Open(const std::string& volume, int points, const std::string& lattice)
{
  this->Image = ReadVolume(volume, this->Problem);
  if (!this->Image)
  {
    return false;
  }
  this->Lattice->SetDimensions(points, points, points);
  this->Lattice->FitToBounds(this->Image->GetBounds());
  if (!lattice.empty() && !this->LoadLattice(lattice))
  {
    return false;
  }
  FindThreshold(this->Image, this->Range, this->Threshold);
  this->SetTransferFunctions();
  this->Mapper->SetInputData(this->Image);
  this->Mapper->SetDeformation(this->Lattice);
  this->Mapper->StillFrameCoherenceOn(); // the widget renders where the pointer comes to a point
  this->Volume->SetMapper(this->Mapper);
  this->Volume->SetProperty(this->Property);
  this->Renderer->SetBackground(0.10, 0.11, 0.13);
  this->Renderer->AddVolume(this->Volume);
  vtkCamera* camera = this->Renderer->GetActiveCamera();
  camera->SetPosition(0.75, -1.0, 0.55);
  camera->SetFocalPoint(0.0, 0.0, 0.0);
  camera->SetViewUp(0.0, 0.0, 1.0);
  this->Renderer->ResetCamera();
  return true;
}

//------------------------------------------------------------------------------
void Editor::SetTransferFunctions()
{
  const double t = this->Threshold;
  const double low = this->Range[0];
  const double high = std::max(this->Range[1], t + 1e-6 * (this->Range[1] - low));
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(t - 0.08 * (high - low), 0.0);
  opacity->AddPoint(t + 0.04 * (high - low), 0.35);
  opacity->AddPoint(high, 0.9);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(low, 0.45, 0.30, 0.25);
  color->AddRGBPoint(t, 0.86, 0.65, 0.48);
  color->AddRGBPoint(0.5 * (t + high), 0.95, 0.88, 0.76);
  color->AddRGBPoint(high, 1.0, 1.0, 1.0);
  this->Property->SetScalarOpacity(opacity);
  this->Property->SetColor(color);
  double spacing[3];
  this->Image->GetSpacing(spacing);
  this->Property->SetScalarOpacityUnitDistance(std::min({ spacing[0], spacing[1], spacing[2] }));
  this->Property->SetInterpolationTypeToLinear();
  this->Property->ShadeOn();
  this->Property->SetSpecular(0.25);
  this->Property->SetSpecularPower(20.0);
}

//------------------------------------------------------------------------------
void Editor::Start(int width, int height, bool interactive)
{
  this->Window->SetSize(width, height);
  this->Window->SetMultiSamples(0);
  this->Window->SetWindowName("vtkFFD lattice editor");
  this->Window->AddRenderer(this->Renderer);
  this->Interactor->SetRenderWindow(this->Window);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  this->Interactor->SetInteractorStyle(style);

  for (vtkTextActor* text : { this->Status.Get(), this->HelpText.Get() })
  {
    text->GetTextProperty()->SetFontFamilyToCourier();
    text->GetTextProperty()->SetFontSize(14);
    text->GetTextProperty()->SetColor(0.9, 0.9, 0.9);
    this->Renderer->AddViewProp(text);
  }
  this->Status->SetPosition(10.0, 8.0);
  this->HelpText->SetInput(Help);
  this->HelpText->GetTextProperty()->SetBackgroundColor(0.0, 0.0, 0.0);
  this->HelpText->GetTextProperty()->SetBackgroundOpacity(0.7);
  this->HelpText->SetPosition(10.0, 40.0);
  this->HelpText->VisibilityOff();

  this->Command->SetCallback(Editor::OnEvent);
  this->Command->SetClientData(this);
  Rep* rep = this->Widget->GetLatticeRepresentation();
  rep->SetLattice(this->Lattice);
  rep->SetProp(this->Volume);
  rep->SetOutlineBounds(this->Image->GetBounds());
  // The volume's own surface is what is grabbed, not the lattice in front of it.
  this->Picker->PickFromListOn();
  this->Picker->AddPickList(this->Volume);
  rep->SetSurfacePicker(this->Picker);
  // Before the frame is drawn, so that the status line tells of what the frame shows.
  this->Renderer->AddObserver(vtkCommand::StartEvent, this->Command);
  // Ahead of the interactor style, behind the widget (0.5).
  this->Interactor->AddObserver(vtkCommand::KeyPressEvent, this->Command, 0.3f);
  this->Interactor->AddObserver(vtkCommand::CharEvent, this->Command, 0.3f);
  this->Widget->SetInteractor(this->Interactor);
  this->Widget->KeyPressActivationOff();
  this->Widget->SetDefaultRenderer(this->Renderer);
  this->Interactor->Initialize();

  this->Renderer->ResetCamera();
  this->Widget->On();
  this->Message = "h: help";
  this->Renderer->ResetCameraClippingRange();
  if (interactive)
  {
    // Coarse pictures before long still ones, which new input aborts.
    this->Frames->SetInteractor(this->Interactor);
  }
  this->Draw();
  // Once more for the time of a frame that is not the first.
  this->Draw();
}

//------------------------------------------------------------------------------
void Editor::Say(const std::string& text)
{
  this->Message = text;
  std::cout << "LatticeEditor: " << text << std::endl;
}

//------------------------------------------------------------------------------
void Editor::ShowStatus()
{
  Rep* rep = this->Widget->GetLatticeRepresentation();
  static const char* const constraints[] = { "", " along x", " along y", " along z", " across x",
    " across y", " across z" };
  static const char* const falloffs[] = { "smooth", "linear", "sphere", "sharp", "constant" };
  static const char* const guards[] = { "", "  no folds",
    rep->IsFolded() ? "  FOLDED" : "  fold warning" };
  std::ostringstream line;
  line << std::fixed << std::setprecision(0) << std::setw(4)
       << 1e3 * this->Renderer->GetLastRenderTimeInSeconds() << " ms  "
       << (this->Before ? "BEFORE" : "after") << "  " << rep->GetNumberOfSelectedPoints()
       << " selected" << constraints[rep->GetConstraint()];
  if (rep->GetProportionalEditing())
  {
    line << "  soft " << falloffs[rep->GetFalloff()] << " " << std::setprecision(1)
         << rep->GetEffectiveRadius();
  }
  for (int a = 0; a < 3; ++a)
  {
    line << (rep->GetSymmetry()[a] ? std::string("  mirror ") + "xyz"[a] : "");
  }
  line << (rep->GetLockBoundary() ? "  locked" : "") << guards[rep->GetFoldGuard()]
       << (rep->GetManipulationMode() == Rep::VOLUME ? "  grab the volume" : "") << "  undo "
       << rep->GetNumberOfUndos() << "  " << this->Message;
  this->Status->SetInput(line.str().c_str());
}

//------------------------------------------------------------------------------
void Editor::OnEvent(vtkObject* caller, unsigned long event, void* client, void*)
{
  auto* self = static_cast<Editor*>(client);
  switch (event)
  {
    case vtkCommand::StartEvent:
      // The time is that of the frame before.
      self->ShowStatus();
      break;
    case vtkCommand::KeyPressEvent:
    {
      const char* key = self->Interactor->GetKeySym();
      self->UsedKey = key && self->OnKey(key);
      self->Command->SetAbortFlag(self->UsedKey ? 1 : 0);
      break;
    }
    default:
      self->Command->SetAbortFlag(self->UsedKey ? 1 : 0);
      self->UsedKey = false;
      break;
  }
  (void)caller;
}

//------------------------------------------------------------------------------
bool Editor::OnKey(const std::string& key)
{
  Rep* rep = this->Widget->GetLatticeRepresentation();
  if (key == "h")
  {
    this->HelpText->SetVisibility(!this->HelpText->GetVisibility());
  }
  else if (key == "Tab")
  {
    this->Before = !this->Before;
    this->Mapper->SetDeformation(this->Before ? nullptr : this->Lattice.Get());
    this->Widget->SetEnabled(this->Before ? 0 : 1);
  }
  else if (key == "bracketleft" || key == "bracketright")
  {
    const double step = 0.02 * (this->Range[1] - this->Range[0]);
    this->Threshold =
      std::min(std::max(this->Threshold + (key == "bracketleft" ? -step : step), this->Range[0]),
        this->Range[1]);
    this->SetTransferFunctions();
  }
  else if (key == "c")
  {
    rep->SetLineMode(rep->GetLineMode() == Rep::CURVED ? Rep::STRAIGHT : Rep::CURVED);
  }
  else if (key == "n")
  {
    rep->SetLabelVisibility(!rep->GetLabelVisibility());
  }
  else if (key == "t")
  {
    this->Widget->SetEnabled(!this->Widget->GetEnabled());
  }
  else if (key == "F2")
  {
    int n[3];
    this->Lattice->GetDimensions(n);
    if (std::max({ n[0], n[1], n[2] }) <= 32 && this->Lattice->Refine(2))
    {
      this->Lattice->GetDimensions(n);
      std::ostringstream text;
      text << n[0] << " x " << n[1] << " x " << n[2] << " control points (undo starts anew)";
      this->Say(text.str());
    }
    else
    {
      this->Say("the lattice is fine enough");
    }
  }
  else if (key == "F5")
  {
    this->Say(this->SaveLattice("lattice.vti") ? "lattice.vti saved" : this->Problem);
  }
  else if (key == "F9")
  {
    this->Say(this->LoadLattice("lattice.vti") ? "lattice.vti loaded" : this->Problem);
  }
  else if (key == "F12")
  {
    this->Say(this->SavePicture("picture.png") ? "picture.png saved" : this->Problem);
  }
  else
  {
    return false;
  }
  this->Draw();
  return true;
}

//------------------------------------------------------------------------------
bool Editor::SavePicture(const std::string& path)
{
  if (this->Frames->GetInteractor())
  {
    this->Frames->RenderStill();
  }
  else
  {
    this->Draw();
  }
  vtkNew<vtkWindowToImageFilter> capture;
  capture->SetInput(this->Window);
  capture->ShouldRerenderOff();
  capture->ReadFrontBufferOff();
  return this->WritePicture(capture, path);
}

//------------------------------------------------------------------------------
/// Without a window: the volume alone.
bool Editor::SaveVolumePicture(const std::string& path, int width, int height)
{
  vtkNew<vtkImageData> picture;
  if (!this->Mapper->RenderToImage(this->Renderer, this->Volume, width, height, picture))
  {
    this->Problem = path + " cannot be made";
    return false;
  }
  vtkNew<vtkImageData> background;
  background->DeepCopy(picture);
  double color[4] = { 0.0, 0.0, 0.0, 1.0 };
  this->Renderer->GetBackground(color);
  for (int c = 0; c < 4; ++c)
  {
    background->GetPointData()->GetScalars()->FillComponent(c, std::round(255.0 * color[c]));
  }
  vtkNew<vtkImageBlend> blend;
  blend->AddInputData(background);
  blend->AddInputData(picture);
  return this->WritePicture(blend, path);
}

//------------------------------------------------------------------------------
bool Editor::WritePicture(vtkAlgorithm* picture, const std::string& path)
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(picture->GetOutputPort());
  writer->SetFileName(path.c_str());
  const Complaints complaints;
  writer->Write();
  if (!complaints.GetFirst().empty() || writer->GetErrorCode() != 0)
  {
    this->Problem = path + " cannot be written: " + complaints.GetFirst();
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool Editor::SaveLattice(const std::string& path)
{
  vtkNew<vtkImageData> image;
  this->Lattice->ToImageData(image);
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(image);
  writer->SetDataModeToBinary(); // that every ParaView reads
  writer->SetFileName(path.c_str());
  const Complaints complaints;
  if (!writer->Write() || !complaints.GetFirst().empty())
  {
    this->Problem = path + " cannot be written: " + complaints.GetFirst();
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool Editor::LoadLattice(const std::string& path)
{
  if (!vtksys::SystemTools::FileExists(path, true))
  {
    this->Problem = path + " cannot be loaded: there is no such file";
    return false;
  }
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(path.c_str());
  // The lattice says itself what is wrong with an image.
  const Complaints complaints;
  reader->Update();
  const bool ok =
    complaints.GetFirst().empty() && this->Lattice->FromImageData(reader->GetOutput()) == 1;
  if (!ok)
  {
    this->Problem = path + " is no lattice: " + complaints.GetFirst();
  }
  return ok;
}

//------------------------------------------------------------------------------
void Editor::Play(const std::string& path)
{
  vtkNew<vtkInteractorEventRecorder> player;
  player->SetInteractor(this->Interactor);
  player->SetFileName(path.c_str());
  player->On();
  player->Play();
  player->Off();
}

} // namespace

//------------------------------------------------------------------------------
int main(int argc, char* argv[])
{
  std::string volume;
  std::string lattice;
  std::string play;
  std::string screenshot;
  std::string save;
  int points = 6;
  int width = 1000;
  int height = 800;
  const auto fail = [](const std::string& text) {
    std::cerr << "LatticeEditor: " << text << "\n";
    return EXIT_FAILURE;
  };
  for (int i = 1; i < argc; ++i)
  {
    const std::string argument = argv[i];
    const int left = argc - 1 - i;
    if (argument == "--help" || argument == "-h")
    {
      std::cout << Usage << "\nin the window:\n" << Help << "\n";
      return EXIT_SUCCESS;
    }
    if (argument == "--size" && left >= 2)
    {
      width = std::atoi(argv[++i]);
      height = std::atoi(argv[++i]);
      if (width < 100 || height < 100 || width > 16384 || height > 16384)
      {
        return fail("--size: from 100 to 16384 pixels each way");
      }
    }
    else if (argument == "--points" && left >= 1)
    {
      points = std::atoi(argv[++i]);
      if (points < 4 || points > 64)
      {
        return fail("--points: from 4 to 64 control points per axis");
      }
    }
    else if (argument == "--lattice" && left >= 1)
    {
      lattice = argv[++i];
    }
    else if (argument == "--play" && left >= 1)
    {
      play = argv[++i];
    }
    else if (argument == "--screenshot" && left >= 1)
    {
      screenshot = argv[++i];
    }
    else if (argument == "--save-lattice" && left >= 1)
    {
      save = argv[++i];
    }
    else if (argument.compare(0, 2, "--") == 0 || !volume.empty())
    {
      return fail("unknown or incomplete argument '" + argument + "'\n" + Usage);
    }
    else
    {
      volume = argument;
    }
  }
  if (volume.empty())
  {
    volume = FFD_EXAMPLE_DATA "/engine.vti";
  }
  if (!play.empty() && !vtksys::SystemTools::FileExists(play, true))
  {
    return fail(play + " cannot be played: there is no such file");
  }
  Editor editor;
  if (!editor.Open(volume, points, lattice))
  {
    return fail(editor.Problem.find("lattice") != std::string::npos
        ? editor.Problem
        : volume + ": " + editor.Problem);
  }
  const bool unattended = !screenshot.empty() || !save.empty();
  const bool window = HasDisplay();
  if (!window)
  {
    const char* display = std::getenv("DISPLAY");
    const std::string problem =
      std::string("no window can be opened: there is no usable X display with GLX (DISPLAY is ") +
      (display && *display ? std::string("'") + display + "'" : std::string("not set")) +
      "). Log in to a desktop, or start the program with xvfb-run.";
    if (!play.empty() || !unattended)
    {
      return fail(problem);
    }
    if (!screenshot.empty())
    {
      std::cout << "LatticeEditor: " << problem << " The picture shows the volume alone."
                << std::endl;
    }
  }
  else
  {
    editor.Start(width, height, play.empty() && !unattended);
  }
  if (!play.empty())
  {
    editor.Play(play);
  }
  if (play.empty() && !unattended)
  {
    editor.Interact();
  }
  if (!screenshot.empty() &&
    !(window ? editor.SavePicture(screenshot)
             : editor.SaveVolumePicture(screenshot, width, height)))
  {
    return fail(editor.Problem);
  }
  if (!save.empty() && !editor.SaveLattice(save))
  {
    return fail(editor.Problem);
  }
  return EXIT_SUCCESS;
}
