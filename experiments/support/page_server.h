// experiments/support/page_server.h — one page over HTTP, to browsers of this machine only.
#pragma once

#include <string>

namespace orthant {

/// Answers every GET / on 127.0.0.1:port with the page until Ctrl-C or SIGTERM; port 0: a free one. The address goes to
/// standard output. Requests whose Host is another than 127.0.0.1 or localhost are refused. Throws std::runtime_error
/// where the port is taken.
void serve_page(const std::string& page, int port);

}  // namespace orthant
