// YAML by yaml-cpp.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <sstream>
#include <utility>

#include "formats/io/json.h"
#include "formats/io/yaml_data.h"

namespace evo {

// Builds the tree from the parser's events, so that keys keep their places and
// an alias costs nothing, however often it is used.
class YamlBuilder : public YAML::EventHandler {
 public:
  explicit YamlBuilder(const std::string& file)
      : file_(std::make_shared<const std::string>(file)) {}

  std::optional<YamlNode> root;
  YAML::Mark start;

  void OnDocumentStart(const YAML::Mark& mark) override { start = mark; }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(begin(YamlNode::Kind::null, mark), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    auto data = begin(YamlNode::Kind::scalar, mark);
    if (!is_utf8(value)) {
      YamlNode node;
      node.data_ = std::move(data);
      throw node.error("text that is not UTF-8");
    }
    data->text = value;
    data->plain = tag == "?";
    add(std::move(data), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = anchors_.find(anchor);
    if (known == anchors_.end()) {
      YamlNode node;
      node.data_ = begin(YamlNode::Kind::null, mark);
      throw node.error("an alias stands inside of what it names");
    }
    attach(known->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({begin(YamlNode::Kind::sequence, mark), anchor, std::nullopt});
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({begin(YamlNode::Kind::mapping, mark), anchor, std::nullopt});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override {
    YamlNode::check_keys(open_.back().data->entries);
    close();
  }

 private:
  struct Open {
    std::shared_ptr<YamlNode::Data> data;
    YAML::anchor_t anchor;
    std::optional<YamlNode> key;  // read, its value is still to come
  };

  std::shared_ptr<YamlNode::Data> begin(YamlNode::Kind kind, const YAML::Mark& mark) const {
    auto data = std::make_shared<YamlNode::Data>();
    data->kind = kind;
    data->file = file_;
    data->line = mark.line + 1;
    data->column = mark.column + 1;
    return data;
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    add(std::move(done.data), done.anchor);
  }

  void add(std::shared_ptr<const YamlNode::Data> data, YAML::anchor_t anchor) {
    YamlNode node;
    node.data_ = std::move(data);
    if (anchor != 0) anchors_[anchor] = node;
    attach(node);
  }

  void attach(const YamlNode& node) {
    if (open_.empty()) {
      root = node;
      return;
    }
    Open& parent = open_.back();
    if (parent.data->kind == YamlNode::Kind::sequence) {
      parent.data->items.push_back(node);
    } else if (!parent.key) {
      parent.key = node;
    } else {
      parent.data->entries.push_back({*parent.key, node});
      parent.key.reset();
    }
  }

  std::shared_ptr<const std::string> file_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNode> anchors_;
};

std::vector<YamlNode> YamlNode::documents(std::string_view text, const std::string& file) {
  std::istringstream stream{std::string(text)};
  std::vector<YamlNode> documents;
  const auto invalid = [&](const YAML::Mark& mark, const std::string& reason) {
    return evo::error(Failure::data, "{}:{}:{}: not valid YAML: {}", file, mark.line + 1,
                      mark.column + 1, reason);
  };
  try {
    YAML::Parser parser(stream);
    for (int last = -1;;) {
      YamlBuilder builder(file);
      if (!parser.HandleNextDocument(builder)) return documents;
      // Before a sign that cannot begin a document the parser finds empty
      // documents without end.
      if (builder.start.pos <= last) throw invalid(builder.start, "no document can begin here");
      last = builder.start.pos;
      if (builder.root) documents.push_back(std::move(*builder.root));
    }
  } catch (const YAML::Exception& failure) {
    throw invalid(failure.mark, failure.msg);
  }
}

}  // namespace evo
