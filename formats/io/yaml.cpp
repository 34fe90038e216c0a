// Node from YAML, by yaml-cpp.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <sstream>
#include <utility>

#include "formats/io/json.h"
#include "formats/io/node_builder.h"

namespace evo {
namespace {

NodeBuilder::Place place_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

// The parser's events, so that keys keep their places and an alias costs nothing, however
// often it is used.
class Events : public YAML::EventHandler {
 public:
  explicit Events(const std::string& name) : file(name), builder(name, false) {}

  const std::string& file;
  NodeBuilder builder;
  YAML::Mark start;

  void OnDocumentStart(const YAML::Mark& mark) override { start = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    builder.null(place_of(mark), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (!is_utf8(value))
      throw error(Failure::data, "{}:{}:{}: text that is not UTF-8", file, mark.line + 1,
                  mark.column + 1);
    builder.scalar(place_of(mark), value, tag == "?", anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    builder.alias(place_of(mark), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    builder.open(Node::Kind::sequence, place_of(mark), anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    builder.open(Node::Kind::mapping, place_of(mark), anchor);
  }
  void OnSequenceEnd() override { builder.close(); }
  void OnMapEnd() override { builder.close(); }
};

}  // namespace

std::vector<Node> Node::yaml_documents(std::string_view text, const std::string& file) {
  std::istringstream stream{std::string(text)};
  std::vector<Node> documents;
  const auto invalid = [&](const YAML::Mark& mark, const std::string& reason) {
    return evo::error(Failure::data, "{}:{}:{}: not valid YAML: {}", file, mark.line + 1,
                      mark.column + 1, reason);
  };
  try {
    YAML::Parser parser(stream);
    for (int last = -1;;) {
      Events events(file);
      if (!parser.HandleNextDocument(events)) return documents;
      // Before a sign that cannot begin a document the parser finds empty
      // documents without end.
      if (events.start.pos <= last) throw invalid(events.start, "no document can begin here");
      last = events.start.pos;
      if (auto document = events.builder.take()) documents.push_back(std::move(*document));
    }
  } catch (const YAML::Exception& failure) {
    throw invalid(failure.mark, failure.msg);
  }
}

}  // namespace evo
