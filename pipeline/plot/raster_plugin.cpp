// The plug-in rsvg: SVG to PNG by librsvg and cairo.
#include <cairo.h>
#include <librsvg/rsvg.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace miebrdf::plot {
namespace {

struct Release {
    void operator()(RsvgHandle* handle) const { g_object_unref(handle); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};

template <typename T>
using Owned = std::unique_ptr<T, Release>;

[[noreturn]] void fail(GError* error) {
    const std::string reason = error != nullptr ? error->message : "unknown reason";
    if (error != nullptr) g_error_free(error);
    throw std::runtime_error("the chart cannot be drawn: " + reason);
}

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

}  // namespace
}  // namespace miebrdf::plot

extern "C" __attribute__((visibility("default"))) void miebrdf_rasterise(const std::string& svg,
                                                                         int width, int height,
                                                                         std::string& png) {
    using namespace miebrdf::plot;
    GError* error = nullptr;
    const Owned<RsvgHandle> handle(rsvg_handle_new_from_data(
        reinterpret_cast<const guint8*>(svg.data()), static_cast<gsize>(svg.size()), &error));
    if (!handle) fail(error);
    const Owned<cairo_surface_t> surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
    const Owned<cairo_t> context(cairo_create(surface.get()));
    const RsvgRectangle page{0, 0, static_cast<double>(width), static_cast<double>(height)};
    if (!rsvg_handle_render_document(handle.get(), context.get(), &page, &error)) fail(error);
    const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &png);
    if (status != CAIRO_STATUS_SUCCESS) {
        throw std::runtime_error(std::string("the chart cannot be drawn: ") +
                                 cairo_status_to_string(status));
    }
}
