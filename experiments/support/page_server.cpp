#include "experiments/support/page_server.h"

#include "experiments/support/stop_signal.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <stdexcept>
#include <string_view>

namespace orthant {
namespace {

constexpr int kPatience = 200;          // [ms] between two looks whether to stop
constexpr std::size_t kRequest = 8192;  // [bytes] of a request that are looked at

[[noreturn]] void refuse(int port, const char* what) {
  throw std::runtime_error("--serve " + std::to_string(port) + ": " + what + ": " + std::strerror(errno));
}

class Socket {
 public:
  explicit Socket(int number) : number_(number) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (number_ >= 0) close(number_);
  }
  int number() const { return number_; }

  bool ready(short what) const {
    pollfd one{number_, what, 0};
    return poll(&one, 1, kPatience) > 0;
  }

 private:
  int number_;
};

/// Whether the request's Host names this machine: a page of another name that has come to mean 127.0.0.1 (DNS
/// rebinding) must not read the run.
bool for_this_machine(std::string_view request) {
  const auto lower = [](std::string_view text) {
    std::string small(text);
    for (char& c : small) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return small;
  };
  int hosts = 0;
  bool ours = false;
  for (std::size_t begin = request.find("\r\n"); begin != std::string_view::npos && begin + 2 < request.size();) {
    begin += 2;
    const std::size_t end = request.find("\r\n", begin);
    const std::string line = lower(request.substr(begin, end - begin));
    begin = end;
    if (!line.starts_with("host:")) continue;
    std::string_view host = std::string_view(line).substr(5);
    while (host.starts_with(' ')) host.remove_prefix(1);
    while (host.ends_with(' ')) host.remove_suffix(1);
    host = host.substr(0, host.rfind(':'));  // the port
    ++hosts, ours = host == "127.0.0.1" || host == "localhost";
  }
  return ours && hosts == 1;
}

/// Of the request its first line matters, and for whom it is.
std::string answer_to(std::string_view request, const std::string& page) {
  const auto head = [](const char* status, const char* type, std::size_t length) {
    return "HTTP/1.1 " + std::string(status) + "\r\nContent-Type: " + type +
           "\r\nContent-Length: " + std::to_string(length) + "\r\nConnection: close\r\n\r\n";
  };
  const auto refuse = [&](const char* status, const std::string& words) {
    return head(status, "text/plain", words.size()) + words;
  };
  if (!for_this_machine(request)) return refuse("403 Forbidden", "Host: must be 127.0.0.1 or localhost\n");
  if (request.starts_with("GET / ")) return head("200 OK", "text/html; charset=utf-8", page.size()) + page;
  return refuse("404 Not Found", "not found\n");
}

void serve_one(const Socket& client, const std::string& page) {
  std::string request;
  while (request.find("\r\n\r\n") == std::string::npos) {  // all of its head
    char part[kRequest];
    if (request.size() >= kRequest || !client.ready(POLLIN)) return;
    const ssize_t length = recv(client.number(), part, sizeof part, 0);
    if (length <= 0) return;
    request.append(part, static_cast<std::size_t>(length));
  }
  const std::string answer = answer_to(request, page);
  for (std::size_t sent = 0; sent < answer.size();) {
    if (StopSignal::which() != 0) return;
    if (!client.ready(POLLOUT)) continue;
    const ssize_t part = send(client.number(), answer.data() + sent, answer.size() - sent, MSG_NOSIGNAL);
    if (part < 0) return;  // the reader has gone
    sent += static_cast<std::size_t>(part);
  }
}

}  // namespace

void serve_page(const std::string& page, int port) {
  const Socket listener(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (listener.number() < 0) refuse(port, "no socket");
  const int yes = 1;
  setsockopt(listener.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  auto* plain = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener.number(), plain, size) != 0 || listen(listener.number(), 8) != 0) refuse(port, "cannot listen");
  getsockname(listener.number(), plain, &size);
  const StopSignal stop;
  std::cout << "view: http://127.0.0.1:" << ntohs(address.sin_port) << "/ until Ctrl-C" << std::endl;
  while (StopSignal::which() == 0)
    if (listener.ready(POLLIN)) {
      const Socket client(accept(listener.number(), nullptr, nullptr));
      if (client.number() >= 0) serve_one(client, page);
    }
}

}  // namespace orthant
