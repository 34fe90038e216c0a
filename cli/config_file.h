// --config FILE.yaml: a flat mapping from long option names to values.
#pragma once

#include <CLI/CLI.hpp>

namespace evo::cli {

class YamlConfig : public CLI::Config {
 public:
  explicit YamlConfig(const CLI::App& app) : app_(app) {}

  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return {}; }

  // Throws Error(data).
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

 private:
  const CLI::App& app_;
};

}  // namespace evo::cli
