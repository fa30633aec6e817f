// The server of `miebrdf studio`: HTTP on this machine's loopback alone, by the plug-in studio.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

namespace miebrdf::program {

struct HttpRequest {
    std::string method, path, body;
    std::map<std::string, std::string> query;
    std::string host, origin, token;  ///< the headers Host, Origin and X-Studio-Token
};

struct HttpReply {
    int status = 200;
    std::string type = "application/json", body = {};
    std::string file_name = {};  ///< what a download is called; empty: it is none
};

struct HttpServer {
    int port = 0;                                              ///< 0: one that is free
    std::size_t most_bytes = 0;                                ///< of a request; larger ones: 413
    std::function<HttpReply(const HttpRequest&)> answer = {};  ///< called by several threads
    std::function<void(int port)> listening = {};              ///< called once, with the port
    std::function<bool()> is_ended = {};                       ///< asked ten times a second
};

/// What the plug-in offers as extern "C" miebrdf_serve: answers until is_ended().
/// @throws UsageError  for a port that cannot be had
using Serve = void(const HttpServer& server);

}  // namespace miebrdf::program
