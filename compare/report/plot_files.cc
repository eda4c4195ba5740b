#include "compare/report/plot_files.h"

#include "compare/format/svg_plot.h"
#include "compare/report/comparison_drawings.h"
#include "scene/base/files.h"

#include <stdexcept>

#ifdef TOUCHSTONE_PDF
#include <cairo-pdf.h>
#include <librsvg/rsvg.h>

#include <memory>
#endif

namespace touchstone::compare {

#ifdef TOUCHSTONE_PDF
namespace {

constexpr double points_per_px = 0.75;

template <auto function>
struct Free {
  template <class T>
  void operator()(T* object) const {
    function(object);
  }
};

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

bool has_pdf() noexcept { return true; }

std::string pdf_of(const std::string& svg) {
  GError* error = nullptr;
  const auto check = [&error](bool good) {
    if (good) return;
    const std::string why = error != nullptr ? error->message : "no reason given";
    g_clear_error(&error);
    throw std::runtime_error("a drawing cannot be made into PDF: " + why);
  };
  const std::unique_ptr<RsvgHandle, Free<g_object_unref>> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error));
  check(handle != nullptr);
  double width_px = 0.0, height_px = 0.0;
  check(rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width_px, &height_px) == TRUE);
  const RsvgRectangle whole{0.0, 0.0, points_per_px * width_px, points_per_px * height_px};
  std::string pdf;
  const std::unique_ptr<cairo_surface_t, Free<cairo_surface_destroy>> surface(
      cairo_pdf_surface_create_for_stream(append, &pdf, whole.width, whole.height));
  const std::unique_ptr<cairo_t, Free<cairo_destroy>> context(cairo_create(surface.get()));
  check(rsvg_handle_render_document(handle.get(), context.get(), &whole, &error) == TRUE);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()) == CAIRO_STATUS_SUCCESS);
  return pdf;
}
#else
bool has_pdf() noexcept { return false; }

std::string pdf_of(const std::string&) { throw std::logic_error("this build has no librsvg"); }
#endif

void write_plots(const std::filesystem::path& folder, const std::vector<Drawing>& drawings) {
  std::filesystem::create_directories(folder);
  // An earlier comparison may have left plots that this one does not have.
  for (const std::string& name : ComparisonDrawings::names()) {
    for (const char* ending : {".svg", ".pdf"}) std::filesystem::remove(folder / (name + ending));
  }
  for (const Drawing& drawing : drawings) {
    const std::string svg = as_file(drawing.svg);
    scene::write_file(folder / (drawing.name + ".svg"), svg);
    if (has_pdf()) scene::write_file(folder / (drawing.name + ".pdf"), pdf_of(svg));
  }
}

}  // namespace touchstone::compare
