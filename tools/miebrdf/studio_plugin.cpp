// The plug-in studio: HTTP by cpp-httplib.
#include <httplib.h>

#include <chrono>
#include <stop_token>
#include <thread>

#include <miebrdf/error.h>
#include "tools/miebrdf/studio_server.h"

namespace {

using miebrdf::program::HttpReply;
using miebrdf::program::HttpRequest;

constexpr std::size_t kThreads = 8;
constexpr time_t kPatienceS = 10;
constexpr char kLoopback[] = "127.0.0.1";

/// The page holds its scripts itself, and speaks to this server alone. Notebooks of this machine
/// may show it in a cell: they have the token.
constexpr char kPolicy[] =
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors http://127.0.0.1:* http://localhost:*";

HttpRequest request_of(const httplib::Request& in) {
    HttpRequest request{in.method,
                        in.path,
                        in.body,
                        {},
                        in.get_header_value("Host"),
                        in.get_header_value("Origin"),
                        in.get_header_value("X-Studio-Token")};
    for (const auto& [name, value] : in.params) request.query.emplace(name, value);
    return request;
}

void write(const HttpReply& reply, httplib::Response& out) {
    out.status = reply.status;
    out.set_header("Content-Security-Policy", kPolicy);
    out.set_header("X-Content-Type-Options", "nosniff");
    out.set_header("Referrer-Policy", "no-referrer");
    out.set_header("Cache-Control", "no-store");
    if (!reply.file_name.empty())
        out.set_header("Content-Disposition", "attachment; filename=\"" + reply.file_name + "\"");
    out.set_content(reply.body, reply.type.c_str());
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void miebrdf_serve(
    const miebrdf::program::HttpServer& wanted) {
    httplib::Server server;
    server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server.set_payload_max_length(wanted.most_bytes);
    server.set_read_timeout(kPatienceS);
    server.set_write_timeout(kPatienceS);
    // Without SO_REUSEPORT, by which two servers would share a port.
    server.set_socket_options([](socket_t socket) {
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const auto answer = [&wanted](const httplib::Request& in, httplib::Response& out) {
        write(wanted.answer(request_of(in)), out);
    };
    server.Get(".*", answer);
    server.Post(".*", answer);
    const int port = wanted.port == 0 ? server.bind_to_any_port(kLoopback)
                     : server.bind_to_port(kLoopback, wanted.port) ? wanted.port
                                                                   : -1;
    if (port < 0) {
        throw miebrdf::UsageError("port " + std::to_string(wanted.port) +
                                  " of 127.0.0.1 cannot be had: another program listens there; "
                                  "give another --port, or none for one that is free");
    }
    const std::jthread watch([&](const std::stop_token& over) {
        while (!over.stop_requested() && !wanted.is_ended())
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        server.stop();
    });
    wanted.listening(port);
    server.listen_after_bind();
}
