#include "compare/view/view.h"

#include "compare/format/polydata.h"
#include "compare/format/svg_plot.h"
#include "compare/format/text.h"
#include "compare/report/picture.h"
#include "scene/base/error.h"
#include "scene/input/scene_io.h"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkAlgorithmOutput.h>
#include <vtkAxis.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkChartLegend.h>
#include <vtkChartXY.h>
#include <vtkContextActor.h>
#include <vtkContextScene.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkJPEGWriter.h>
#include <vtkLookupTable.h>
#include <vtkMatrix4x4.h>
#include <vtkNamedColors.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSliderRepresentation2D.h>
#include <vtkSliderWidget.h>
#include <vtkTable.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

namespace touchstone::compare {
namespace {

constexpr int width_px = 1280, height_px = 760;
/// Fraction of the window for the body; the curve has the rest.
constexpr double body_share = 0.62;
constexpr std::array ink = {0.11, 0.12, 0.13};
/// Grey of a point whose value is not known.
constexpr double unknown_grey = 0.75;
constexpr int tool_triangles = 3000;
/// In percent; high, so that thin lines and letters stay sharp.
constexpr int jpeg_quality = 95;

struct Key {
  std::string_view name, shown, meaning;
};
constexpr Key keys[] = {{"Left", "left, right", "one instant back, on"},
                        {"Right", "", ""},
                        {"Home", "home, end", "first, last instant"},
                        {"End", "", ""},
                        {"b", "b", "the other body: reference, fast model"},
                        {"c", "c", "the next colour: displacement, error, uncertainty"},
                        {"t", "t", "tool shown or not"},
                        {"r", "r", "first view"},
                        {"h", "h", "this help"},
                        {"q", "q", "close"}};

/// A body that can be shown, or a quantity to colour it by: names of point arrays.
struct Body {
  std::string name, displacement;
};
struct Colouring {
  std::string name, array;  ///< array "": the displacement of the shown body
  ColourMap map;
};

vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw scene::InputError({{file.string(), 0, 0, "is missing; expected one surface per line of curve.csv"}});
  }
  vtkNew<vtkXMLPolyDataReader> reader;
  bool failed = false;
  vtkNew<vtkCallbackCommand> note;
  note->SetClientData(&failed);
  note->SetCallback([](vtkObject*, unsigned long, void* client, void*) { *static_cast<bool*>(client) = true; });
  reader->AddObserver(vtkCommand::ErrorEvent, note);
  reader->SetFileName(file.c_str());
  reader->Update();
  if (failed || reader->GetOutput()->GetNumberOfPoints() == 0) {
    throw scene::InputError({{file.string(), 0, 0, "is no VTK surface; was it cut off or edited?"}});
  }
  return reader->GetOutput();
}

/// Magnitude of the total force per instant, from columns "<prefix>regionN_force_x_n".
std::vector<double> force_n(const ResultFolder& result, const std::string& prefix) {
  std::vector<Eigen::Vector3d> sum(result.required_column("time_s").size(), Eigen::Vector3d::Zero());
  for (int region = 0; result.column(fmt::format("{}region{}_force_x_n", prefix, region)) != nullptr; ++region) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto& values = result.required_column(fmt::format("{}region{}_force_{}_n", prefix, region, "xyz"[axis]));
      for (std::size_t t = 0; t < sum.size(); ++t) sum[t][axis] += values[t];
    }
  }
  std::vector<double> out;
  for (const Eigen::Vector3d& force : sum) out.push_back(force.norm());
  return out;
}

vtkSmartPointer<vtkTable> table_of(const std::vector<scene::Column>& columns) {
  auto table = vtkSmartPointer<vtkTable>::New();
  for (const scene::Column& column : columns) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(column.name.c_str());
    for (const double v : column.values) array->InsertNextValue(v);
    table->AddColumn(array);
  }
  return table;
}

vtkSmartPointer<vtkLookupTable> lookup_table(ColourMap map) {
  const auto& steps = colour_table(map);
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  constexpr int entries = 256;
  table->SetNumberOfTableValues(entries);
  table->SetNanColor(unknown_grey, unknown_grey, unknown_grey, 1.0);
  for (int i = 0; i < entries; ++i) {
    const double at = static_cast<double>(i) / (entries - 1) * static_cast<double>(steps.size() - 1);
    const std::size_t low = std::min(static_cast<std::size_t>(at), steps.size() - 2);
    const double share = at - static_cast<double>(low);
    std::array<double, 3> rgb{};
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = ((1 - share) * steps[low][k] + share * steps[low + 1][k]) / 255.0;
    table->SetTableValue(i, rgb[0], rgb[1], rgb[2]);
  }
  return table;
}

/// Rotates with the mouse; passes all keys on, because VTK's own style uses letters for itself.
class Style : public vtkInteractorStyleTrackballCamera {
 public:
  static Style* New();
  vtkTypeMacro(Style, vtkInteractorStyleTrackballCamera);
  std::function<void(const std::string&)> on_key;
  void OnKeyPress() override { on_key(this->Interactor->GetKeySym()); }
  void OnChar() override {}
};
vtkStandardNewMacro(Style);

void set_ink(vtkTextProperty* text, int size) {
  text->SetColor(ink[0], ink[1], ink[2]);
  text->SetFontSize(size);
  text->ItalicOff();
  text->BoldOff();
  text->ShadowOff();
}

enum class PictureFormat { png, jpeg };

/// By the file's extension in upper or lower case; nothing for an unknown one.
std::optional<PictureFormat> format_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".png") return PictureFormat::png;
  if (ending == ".jpg" || ending == ".jpeg") return PictureFormat::jpeg;
  return std::nullopt;
}

/// The encoded image file.
template <class Writer>
std::string encoded(vtkAlgorithmOutput* image, Writer* writer) {
  writer->SetInputConnection(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)), static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

}  // namespace

struct ResultView::Parts {
  std::vector<vtkSmartPointer<vtkPolyData>> surfaces;
  std::vector<Body> bodies;
  std::vector<Colouring> colourings;
  std::vector<double> time_s, depth_m;
  std::vector<scene::Column> forces;  ///< one per side, named as in the legend
  std::vector<scene::Pose> poses;
  std::size_t instant = 0, body = 0, colouring = 0;
  std::map<std::pair<std::size_t, std::size_t>, double> full_scales_m;  ///< by body and colouring, computed when needed

  vtkNew<vtkPolyData> shown;
  vtkNew<vtkPolyDataNormals> normals;
  vtkNew<vtkPolyDataMapper> body_mapper, tool_mapper;
  vtkNew<vtkActor> body_actor, tool_actor;
  vtkNew<vtkScalarBarActor> bar;
  vtkNew<vtkTextActor> words, help;
  vtkNew<vtkRenderer> space, curve;
  vtkNew<vtkContextActor> chart_actor;
  vtkNew<vtkChartXY> chart;
  vtkSmartPointer<vtkTable> cursor;
  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderWindowInteractor> interactor;
  vtkNew<Style> style;
  vtkNew<vtkSliderRepresentation2D> slider_look;
  vtkNew<vtkSliderWidget> slider;

  void find_arrays() {
    vtkPointData* data = surfaces.front()->GetPointData();
    const auto add_body = [&](const char* name, const char* array) {
      if (data->HasArray(array) != 0) bodies.push_back({name, array});
    };
    const auto add_colouring = [&](const char* name, const char* array) {
      if (data->HasArray(array) != 0) colourings.push_back({name, array, ColourMap::error});
    };
    add_body("reference", "displacement_reference_m");
    add_body("fast model", "displacement_fast_m");
    add_body("body", "displacement_m");
    colourings.push_back({"displacement", "", ColourMap::displacement});
    add_colouring("error", "displacement_error_magnitude_m");
    add_colouring("uncertainty", "displacement_reference_uncertainty_m");
    add_colouring("uncertainty", "displacement_uncertainty_m");
  }

  /// Value at one point and one instant [m].
  [[nodiscard]] double value_m(std::size_t at, vtkIdType point) const {
    vtkPointData* data = surfaces[at]->GetPointData();
    const std::string& array = colourings[colouring].array;
    if (!array.empty()) return data->GetArray(array.c_str())->GetComponent(point, 0);
    double u[3];
    data->GetArray(bodies[body].displacement.c_str())->GetTuple(point, u);
    return std::hypot(u[0], u[1], u[2]);
  }

  /// Maximum over all instants, so that a colour has the same meaning at all of them.
  [[nodiscard]] double full_scale_m() {
    const auto [known, is_new] = full_scales_m.try_emplace({body, colouring}, 0.0);
    double& found = known->second;
    if (!is_new) return found;
    for (std::size_t t = 0; t < surfaces.size(); ++t) {
      for (vtkIdType i = 0; i < surfaces[t]->GetNumberOfPoints(); ++i) {
        if (const double value = value_m(t, i); std::isfinite(value)) found = std::max(found, value);
      }
    }
    return found;
  }

  /// Whether the colouring has a value anywhere at this instant.
  [[nodiscard]] bool any_value() const {
    for (vtkIdType i = 0; i < surfaces[instant]->GetNumberOfPoints(); ++i) {
      if (std::isfinite(value_m(instant, i))) return true;
    }
    return false;
  }

  void make_space(const ResultFolder& result) {
    shown->DeepCopy(surfaces.front());
    shown->GetPointData()->Initialize();
    normals->SetInputData(shown);
    normals->SplittingOff();
    body_mapper->SetInputConnection(normals->GetOutputPort());
    body_actor->SetMapper(body_mapper);
    body_actor->GetProperty()->SetAmbient(0.25);
    body_actor->GetProperty()->SetDiffuse(0.75);
    space->AddActor(body_actor);

    const scene::Scene scene = scene::parse_scene(result.resolved_scene, result.folder / "manifest.json");
    const scene::Surface tool = scene::tool_surface(scene.tool, tool_triangles);
    tool_mapper->SetInputData(polydata_of(tool.points_m, tool.triangles));
    tool_actor->SetMapper(tool_mapper);
    tool_actor->GetProperty()->SetColor(0.5, 0.5, 0.53);
    tool_actor->GetProperty()->SetOpacity(0.35);
    space->AddActor(tool_actor);

    bar->SetNumberOfLabels(5);
    bar->UnconstrainedFontSizeOn();
    set_ink(bar->GetTitleTextProperty(), 16);
    set_ink(bar->GetLabelTextProperty(), 15);
    bar->SetPosition(0.86, 0.3);
    bar->SetWidth(0.1);
    bar->SetHeight(0.45);
    bar->SetLabelFormat("%.3g");
    space->AddActor2D(bar);

    set_ink(words->GetTextProperty(), 17);
    words->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    words->SetPosition(0.02, 0.91);
    space->AddActor2D(words);
    set_ink(help->GetTextProperty(), 15);
    help->GetTextProperty()->SetFontFamilyToCourier();
    help->GetTextProperty()->SetBackgroundColor(1.0, 1.0, 1.0);
    help->GetTextProperty()->SetBackgroundOpacity(0.85);
    help->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    help->SetPosition(0.02, 0.5);
    help->SetInput(keys_text().c_str());
    help->VisibilityOff();
    space->AddActor2D(help);
    space->SetBackground(1.0, 1.0, 1.0);
    space->SetViewport(0.0, 0.0, body_share, 1.0);
    first_view();
  }

  /// The view is from the front, above and slightly from the right, as in the report.
  void first_view() {
    vtkCamera* camera = space->GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetFocalPoint(0.0, 0.0, 0.0);
    camera->SetPosition(0.352, -0.791, 0.5);
    camera->SetViewUp(0.0, 0.0, 1.0);
    space->ResetCamera(surfaces.front()->GetBounds());
    camera->Zoom(0.8);  // leaves space for the text and the colour bar
  }

  void make_curve() {
    std::vector<scene::Column> columns = {{"time [s]", time_s}};
    double peak_n = 0.0;
    for (const scene::Column& force : forces) {
      columns.push_back(force);
      for (const double v : force.values) peak_n = std::max(peak_n, std::isfinite(v) ? v : 0.0);
    }
    const auto table = table_of(columns);
    vtkNew<vtkNamedColors> names;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      vtkPlot* plot = chart->AddPlot(vtkChart::LINE);
      plot->SetInputData(table, 0, static_cast<vtkIdType>(i) + 1);
      const Look look = forces[i].name == "fast model" ? Look::fast : Look::reference;
      const vtkColor3ub rgb = names->HTMLColorToRGB(touchstone::compare::colour(look));
      plot->SetColor(rgb.GetRed(), rgb.GetGreen(), rgb.GetBlue(), 255);
      plot->SetWidth(2.0F);
      if (look == Look::fast) plot->GetPen()->SetLineType(vtkPen::DASH_LINE);
    }
    cursor = table_of({{"cursor time", {0.0, 0.0}}, {"instant", {0.0, peak_n > 0.0 ? peak_n : 1.0}}});
    vtkPlot* line = chart->AddPlot(vtkChart::LINE);
    line->SetInputData(cursor, 0, 1);
    line->SetColor(ink[0], ink[1], ink[2]);
    chart->SetShowLegend(true);
    chart->GetLegend()->SetHorizontalAlignment(vtkChartLegend::LEFT);
    chart->SetTitle("Force on the tool");
    chart->GetAxis(vtkAxis::BOTTOM)->SetTitle("time [s]");
    chart->GetAxis(vtkAxis::LEFT)->SetTitle("force [N]");
    chart_actor->GetScene()->AddItem(chart);
    chart_actor->GetScene()->SetRenderer(curve);
    curve->AddActor(chart_actor);
    curve->SetBackground(1.0, 1.0, 1.0);
    curve->SetViewport(body_share, 0.0, 1.0, 1.0);
  }

  void make_window() {
    window->AddRenderer(space);
    window->AddRenderer(curve);
    window->SetSize(width_px, height_px);
    window->SetMultiSamples(4);
  }

  /// Draws the body again with its colours.
  void show() {
    vtkPolyData* surface = surfaces[instant];
    vtkDataArray* move = surface->GetPointData()->GetArray(bodies[body].displacement.c_str());
    const vtkIdType count = surface->GetNumberOfPoints();
    vtkNew<vtkPoints> places;
    vtkNew<vtkDoubleArray> values_mm;
    for (vtkIdType i = 0; i < count; ++i) {
      double rest[3], u[3];
      surface->GetPoint(i, rest);
      move->GetTuple(i, u);
      places->InsertNextPoint(rest[0] + u[0], rest[1] + u[1], rest[2] + u[2]);
      values_mm->InsertNextValue(1e3 * value_m(instant, i));
    }
    shown->SetPoints(places);
    shown->GetPointData()->SetScalars(values_mm);
    shown->Modified();
    const double full_mm = 1e3 * full_scale_m();
    const auto table = lookup_table(colourings[colouring].map);
    table->SetTableRange(0.0, full_mm > 0.0 ? full_mm : 1.0);
    body_mapper->SetLookupTable(table);
    body_mapper->UseLookupTableScalarRangeOn();
    bar->SetLookupTable(table);
    bar->SetTitle((colourings[colouring].name + "\n[mm]\n").c_str());
    const bool known = any_value();
    bar->SetVisibility(known ? 1 : 0);

    const scene::Pose& pose = poses[instant];
    vtkNew<vtkMatrix4x4> matrix;
    const Eigen::Matrix3d turn = pose.orientation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix->SetElement(row, column, turn(row, column));
      matrix->SetElement(row, 3, pose.position_m[row]);
    }
    tool_actor->SetUserMatrix(matrix);

    std::string text = fmt::format("{}, instant {} of {}: {} s, {} deep\n", bodies[body].name, instant + 1,
                                   surfaces.size(), number_text(time_s[instant]), quantity_text(depth_m[instant], "m"));
    for (const scene::Column& force : forces) {
      text += fmt::format("{} {}   ", force.name, quantity_text(force.values[instant], "N"));
    }
    if (!known) text += "\nThe " + colourings[colouring].name + " is unknown: the body is grey.\n";
    words->SetInput((text + "  (h: keys)").c_str());
    for (const vtkIdType row : {0, 1}) cursor->SetValue(row, 0, time_s[instant]);
    cursor->Modified();
    slider_look->SetValue(static_cast<double>(instant + 1));
    space->ResetCameraClippingRange();
  }
};

ResultView::ResultView(const ResultFolder& result) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.time_s = result.required_column("time_s");
  p.depth_m = result.required_column("depth_m");
  const auto pose_column = [&](const char* name) -> const std::vector<double>& {
    return result.required_column(std::string("tool_") + name);
  };
  for (std::size_t t = 0; t < p.time_s.size(); ++t) {
    scene::Pose pose;
    pose.position_m = {pose_column("x_m")[t], pose_column("y_m")[t], pose_column("z_m")[t]};
    pose.orientation = {pose_column("qw")[t], pose_column("qx")[t], pose_column("qy")[t], pose_column("qz")[t]};
    p.poses.push_back(pose);
    const std::filesystem::path file = result.folder / fmt::format("surface_{:04}.vtp", t);
    p.surfaces.push_back(read_surface(file));
    if (p.surfaces.back()->GetNumberOfPoints() != p.surfaces.front()->GetNumberOfPoints()) {
      throw scene::InputError(
          {{file.string(), 0, 0,
            fmt::format("has {} points, expected {} as in surface_0000.vtp", p.surfaces.back()->GetNumberOfPoints(),
                        p.surfaces.front()->GetNumberOfPoints())}});
    }
  }
  if (p.surfaces.empty()) throw scene::InputError({{(result.folder / "curve.csv").string(), 0, 0, "has no instants"}});
  p.find_arrays();
  if (p.bodies.empty()) {
    throw scene::InputError({{(result.folder / "surface_0000.vtp").string(), 0, 0, "has no displacement to show"}});
  }
  if (p.bodies.size() > 1) {
    p.forces = {{"reference", result.required_column("reference_force_n")},
                {"fast model", result.required_column("fast_force_n")}};
  } else {
    p.forces = {{result.command == "touchstone reference" ? "reference" : "fast model", force_n(result, "")}};
  }
  p.make_space(result);
  p.make_curve();
  p.make_window();
  const auto deepest = std::max_element(p.depth_m.begin(), p.depth_m.end());
  show_instant(deepest - p.depth_m.begin());
}

ResultView::~ResultView() = default;

std::size_t ResultView::instant_count() const { return parts_->surfaces.size(); }
std::size_t ResultView::instant() const { return parts_->instant; }
std::string ResultView::side() const { return parts_->bodies[parts_->body].name; }
std::string ResultView::colour() const { return parts_->colourings[parts_->colouring].name; }

std::string ResultView::words() const { return parts_->words->GetInput(); }

void ResultView::show_instant(long instant) {
  parts_->instant = static_cast<std::size_t>(std::clamp(instant, 0L, static_cast<long>(instant_count()) - 1));
  parts_->show();
}

bool ResultView::press(const std::string& key) {
  Parts& p = *parts_;
  const long at = static_cast<long>(p.instant);
  if (key == "Left") {
    show_instant(at - 1);
  } else if (key == "Right") {
    show_instant(at + 1);
  } else if (key == "Home") {
    show_instant(0);
  } else if (key == "End") {
    show_instant(static_cast<long>(instant_count()) - 1);
  } else if (key == "b") {
    p.body = (p.body + 1) % p.bodies.size();
    p.show();
  } else if (key == "c") {
    p.colouring = (p.colouring + 1) % p.colourings.size();
    p.show();
  } else if (key == "t") {
    p.tool_actor->SetVisibility(p.tool_actor->GetVisibility() == 0);
  } else if (key == "r") {
    p.first_view();
  } else if (key == "h") {
    p.help->SetVisibility(p.help->GetVisibility() == 0);
  } else if (key == "q") {
    p.interactor->TerminateApp();
  } else {
    return false;
  }
  return true;
}

std::string ResultView::keys_text() {
  std::string text;
  for (const Key& key : keys) {
    if (!key.shown.empty()) text += fmt::format("{:<12} {}\n", key.shown, key.meaning);
  }
  return text + fmt::format("{:<12} {}", "mouse", "turn; wheel: zoom; middle button: move");
}

bool ResultView::can_write(const std::filesystem::path& file) { return format_of(file).has_value(); }

void ResultView::write_picture(const std::filesystem::path& file) {
  const std::optional<PictureFormat> format = format_of(file);
  if (!format) throw scene::InputError({{file.string(), 0, 0, "unknown extension; expected .png, .jpg or .jpeg"}});
  parts_->window->SetOffScreenRendering(1);
  parts_->window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(parts_->window);
  image->ReadFrontBufferOff();
  if (*format == PictureFormat::jpeg) {
    vtkNew<vtkJPEGWriter> writer;
    writer->SetQuality(jpeg_quality);
    scene::write_file(file, encoded(image->GetOutputPort(), writer.Get()));
  } else {
    vtkNew<vtkPNGWriter> writer;
    scene::write_file(file, encoded(image->GetOutputPort(), writer.Get()));
  }
}

void ResultView::run() {
  Parts& p = *parts_;
  p.window->SetWindowName("Touchstone");
  p.interactor->SetRenderWindow(p.window);
  p.interactor->SetInteractorStyle(p.style);
  p.style->SetDefaultRenderer(p.space);
  p.style->on_key = [this](const std::string& key) {
    if (press(key) && key != "q") parts_->window->Render();
  };
  p.slider_look->SetMinimumValue(1.0);
  p.slider_look->SetMaximumValue(static_cast<double>(std::max<std::size_t>(instant_count(), 2)));
  p.slider_look->SetValue(static_cast<double>(p.instant + 1));
  p.slider_look->SetTitleText("instant");
  p.slider_look->SetLabelFormat("%.0f");
  set_ink(p.slider_look->GetTitleProperty(), 14);
  set_ink(p.slider_look->GetLabelProperty(), 14);
  p.slider_look->GetSliderProperty()->SetColor(0.12, 0.47, 0.71);
  p.slider_look->GetTubeProperty()->SetColor(0.8, 0.82, 0.84);
  p.slider_look->GetPoint1Coordinate()->SetCoordinateSystemToNormalizedDisplay();
  p.slider_look->GetPoint1Coordinate()->SetValue(0.05, 0.07);
  p.slider_look->GetPoint2Coordinate()->SetCoordinateSystemToNormalizedDisplay();
  p.slider_look->GetPoint2Coordinate()->SetValue(body_share - 0.05, 0.07);
  p.slider->SetInteractor(p.interactor);
  p.slider->SetRepresentation(p.slider_look);
  p.slider->SetCurrentRenderer(p.space);
  vtkNew<vtkCallbackCommand> moved;
  moved->SetClientData(this);
  moved->SetCallback([](vtkObject*, unsigned long, void* client, void*) {
    auto* view = static_cast<ResultView*>(client);
    view->show_instant(std::lround(view->parts_->slider_look->GetValue()) - 1);
  });
  p.slider->AddObserver(vtkCommand::InteractionEvent, moved);
  p.interactor->Initialize();
  p.slider->EnabledOn();
  p.window->Render();
  p.interactor->Start();
}

}  // namespace touchstone::compare
