// --mode json: a request a line, an answer a line.
#include "cli/env/request.h"
#include "cli/env/serve.h"
#include "cli/env/stream.h"
#include "formats/io/base64.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace {

constexpr std::size_t longest_line = std::size_t{64} << 20U;

Json answer_document(const Session& session, const Answer& answer, const std::string& where) {
  switch (answer.kind) {
    case Answer::Kind::state:
      return state_document(session, answer.environments);
    case Answer::Kind::document:
      return answer.document;
    case Answer::Kind::saved: {
      Json states = Json::array();
      for (const std::vector<std::uint8_t>& state : answer.saved)
        states.push_back(base64({reinterpret_cast<const char*>(state.data()), state.size()}));
      return {{"environments", answer.environments}, {"states", std::move(states)}};
    }
    case Answer::Kind::picture:
      break;
  }
  throw error(Failure::usage, "{}: pictures are for --mode binary; evo-render draws rollouts",
              where);
}

}  // namespace

void serve_lines(Session& session, int input, int output) {
  InputStream in(input);
  Requests requests(session);
  const auto send = [&](const Json& document) { write_all(output, compact(document) + "\n"); };
  try {
    send(describe(session));
    std::string line;
    for (std::size_t number = 1;; ++number) {
      const InputStream::Line read = in.read_line(line, longest_line);
      if (read == InputStream::Line::none) return;
      const std::string where = fmt::format("request {}", number);
      if (read == InputStream::Line::endless) {
        const Error failure =
            error(Failure::data, "{}: the line does not end, nor can another begin", where);
        send({{"error", failure.what()}});
        throw failure;
      }
      try {
        if (read == InputStream::Line::too_long)
          throw error(Failure::data, "{}: the line is longer than {} bytes", where, longest_line);
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        send(answer_document(session, requests.answer(parse_json(line, where), where), where));
      } catch (const Error& failure) {
        if (failure.kind() == Failure::io) throw;
        send({{"error", failure.what()}});
      }
    }
  } catch (const ClientGone&) {
    return;
  }
}

}  // namespace evo::cli
