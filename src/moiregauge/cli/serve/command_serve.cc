// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/serve/command_serve.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tl/expected.hpp>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/server/web_server.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kMinToken = 16, kMaxToken = 128;  // characters

struct ServeArgs {
  std::string folder = ".";
  std::optional<int> port;
  std::string listen, token_file, certificate, key;
  double max_upload_gb = 64.0;
  int jobs = 1;
  bool quiet = false;
};

tl::unexpected<std::string> serve_mistake(std::string message) { return tl::unexpected(std::move(message)); }

// Reads a secret from a file, so that it is not in the list of processes.
tl::expected<std::string, std::string> token_in(const std::string& path) {
  const std::string other = kind_unless_plain(path);
  std::ifstream in(path);
  std::string token;
  if (!other.empty() || !std::getline(in, token))
    return serve_mistake(
        fmt::format("the token cannot be read: --token-file {}: give a plain file with one line", path));
  const bool is_word = std::ranges::all_of(
      token, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
  if (token.size() < kMinToken || token.size() > kMaxToken || !is_word)
    return serve_mistake(fmt::format("the token is not usable: --token-file {}: write {} to {} letters and digits",
                                     path, kMinToken, kMaxToken));
  return token;
}

tl::expected<void, std::string> read_listen(const ServeArgs& args, ServeOptions& options) {
  if (args.listen.empty()) {
    if (!args.certificate.empty() || !args.key.empty())
      return serve_mistake("--certificate and --key apply to --listen only: serve: add --listen ADDRESS:PORT");
    return {};
  }
  if (args.port) return serve_mistake("--port and --listen exclude each other: serve: write the port into --listen");
  if (args.certificate.empty() || args.key.empty())
    return serve_mistake(fmt::format(
        "the connection would not be encrypted: --listen {}: add --certificate FILE and --key FILE", args.listen));
  auto address = listen_address(args.listen);
  if (!address)
    return serve_mistake(fmt::format("the address cannot be read: --listen {}: {}", args.listen, address.error()));
  options.address = *std::move(address);
  options.is_beyond_loopback = true;
  options.certificate = args.certificate;
  options.key = args.key;
  return {};
}

tl::expected<ServeOptions, std::string> serve_options(const ServeArgs& args) {
  ServeOptions options;
  options.folder = args.folder;
  options.address.port = args.port.value_or(8765);
  options.jobs_at_once = args.jobs;
  options.max_upload = static_cast<std::int64_t>(args.max_upload_gb * 1e9);
  if (const auto read = read_listen(args, options); !read) return tl::unexpected(read.error());
  if (args.token_file.empty()) return options;
  auto token = token_in(args.token_file);
  if (!token) return tl::unexpected(token.error());
  options.token = *std::move(token);
  return options;
}

// A thousand idle connections exceed the usual limit of open files.
void raise_file_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 8192);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

int run(const ServeArgs& args) {
  const auto options = serve_options(args);
  if (!options) return fail(Exit::kUsage, options.error());
  raise_file_limit();
  const InterruptGuard guard;
  const auto server = WebServer::open(*options);
  if (!server)
    return fail(server.error().problem == ServeProblem::kPort ? Exit::kOutputUnwritable : Exit::kUsage,
                server.error().message);
  print_out((*server)->url() + "\n");
  (void)finish_output();
  if (!args.quiet)
    print_note("Open this address in a browser. Ctrl-C ends the server; runs in progress stay resumable.\n");
  (*server)->run([] { return !interrupted(); });
  return 0;
}

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("serve", "Measure in a web browser: a page for the clips of a folder");
  auto args = std::make_shared<ServeArgs>();
  command->add_option("FOLDER", args->folder, "folder with the clips [the current one]")->type_name("DIR");
  command->add_option("--port", args->port, "port on this computer; 0: any free one [8765]")
      ->check(CLI::Range(0, 65535).description(""))
      ->type_name("N");
  command->add_option("--jobs", args->jobs, "commands that run at the same time [1]")
      ->check(CLI::Range(1, 64).description(""))
      ->type_name("N");
  command->add_option("--listen", args->listen, "serve other computers too, with TLS and a token: ADDRESS:PORT")
      ->type_name("ADDRESS:PORT");
  command->add_option("--certificate", args->certificate, "certificate chain of --listen, PEM")->type_name("FILE");
  command->add_option("--key", args->key, "private key of --listen, PEM")->type_name("FILE");
  command->add_option("--token-file", args->token_file, "file with the token [a random one]")->type_name("FILE");
  command->add_option("--max-upload", args->max_upload_gb, "largest file to receive, GB [64]")
      ->check(CLI::Range(0.0, 100000.0).description(""))
      ->type_name("N");
  command->add_flag("--quiet", args->quiet, "print nothing but the address and errors");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
