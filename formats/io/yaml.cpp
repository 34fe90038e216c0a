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
  Events(std::string_view whole, const std::string& name)
      : text(whole), file(name), builder(name, false) {}

  std::string_view text;
  const std::string& file;
  NodeBuilder builder;
  YAML::Mark start;
  std::vector<bool> in_sequence;  // whether what is open is one

  void OnDocumentStart(const YAML::Mark& mark) override { start = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    // yaml-cpp takes "[1,,2]", which YAML has not, for a list of three.
    const auto at = static_cast<std::size_t>(mark.pos);
    if (!in_sequence.empty() && in_sequence.back() && at < text.size() && text[at] == ',')
      throw YAML::ParserException(mark, "nothing before the comma");
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
    in_sequence.push_back(true);
    builder.open(Node::Kind::sequence, place_of(mark), anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    in_sequence.push_back(false);
    builder.open(Node::Kind::mapping, place_of(mark), anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  void close() {
    in_sequence.pop_back();
    builder.close();
  }
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
      Events events(text, file);
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
