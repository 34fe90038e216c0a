// Profiles: named sets of settings as YAML, each starting from another one and
// giving only what differs. What physics and training profiles have in common.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/io/settings.h"

namespace evo {

template <typename Settings>
class Profiles {
 public:
  // `kind` names the subfolder of the data folders, and with `setting` ("physics", "constant")
  // what messages speak of. `root` is the profile that others start from unless they say `base`:
  // Settings{} stands for it where no folder has it.
  Profiles(std::string kind, const char* setting, const Format& format, const char* root,
           SettingTable<Settings> table)
      : kind_(std::move(kind)),
        profile_(kind_ + " profile"),
        setting_(fmt::format("{} {}", kind_, setting)),
        format_(format),
        root_(root),
        table_(std::move(table)) {}

  // A profile by name ("paper"), or by file (a name with '/' or ending in .yaml).
  // Throws Error(usage) for an unknown name, Error(no_input), Error(data).
  Settings load(const std::string& name_or_file, const DataFolders& folders) const {
    return load(name_or_file, "", folders, 0);
  }

  // The profile in a mapping of settings. A base that is a file is looked for in `folder`.
  Settings read(const Node& node, const std::filesystem::path& folder,
                const DataFolders& folders) const {
    return read(node, folder, folders, 0);
  }

  // Sets one: "gravity=50", "hidden=32,32". Throws Error(usage). Whether settings make sense
  // together is left to check(), since there may be more to assign.
  void assign(Settings& settings, std::string_view assignment) const {
    table_.assign(settings, assignment, setting_.c_str());
  }
  // Throws Error(usage) for settings that make no sense together.
  void check(const Settings& settings) const { table_.check(settings); }

  // The complete profile, each setting with unit and meaning; numbers are exact: read() gives
  // the same settings.
  std::string to_yaml(const Settings& settings) const {
    return fmt::format("format: {}\nversion: {}\n", format_.name, format_.version) +
           setting::to_yaml(rows(settings), "");
  }

  // Every setting with what there is to know of it, in the order of the profile.
  std::vector<SettingRow> rows(const Settings& settings) const { return table_.rows(settings); }

  // "physics.gravity=50": what decides a result, a line per setting.
  std::vector<std::string> identity(const Settings& settings) const {
    return table_.identity(settings, kind_);
  }

  Json schema() const { return table_.schema(format_); }

 private:
  static constexpr int longest_chain = 16;  // of profiles that start from one another

  Settings load(const std::string& name_or_file, const std::filesystem::path& folder,
                const DataFolders& folders, int depth) const {
    const auto load_file = [&](const std::filesystem::path& path, const DataFolders& bases) {
      return read(Node::yaml(read_file(path, largest_document), path.string()), path.parent_path(),
                  bases, depth);
    };
    const bool is_root = name_or_file == root_;
    if (is_file_name(name_or_file)) return load_file(folder / name_or_file, folders);
    // The root's file starts from what is built in, not from itself.
    if (const auto path = find_data_file(folders, kind_, name_or_file))
      return load_file(*path, is_root ? DataFolders{} : folders);
    if (is_root) return Settings{};
    std::vector<std::string> known = data_names(folders, kind_);
    if (known.empty()) known.push_back(root_);
    throw Error(Failure::usage,
                unknown_name(profile_, name_or_file, known) + ", or a file (NAME.yaml)");
  }

  Settings read(const Node& node, const std::filesystem::path& folder, const DataFolders& folders,
                int depth) const {
    std::vector<std::string> allowed{"format", "version", "name", "description", "base"};
    for (std::string& key : table_.outer_keys()) allowed.push_back(std::move(key));
    const Mapping profile(node, profile_, allowed);
    check_format(profile.node(), format_);

    const auto base = profile.find("base");
    if (base && depth >= longest_chain)
      throw base->error("profiles start from one another in a circle");
    const auto base_settings = [&] {
      try {
        return load(base ? base->string() : root_, folder, folders, depth + 1);
      } catch (const Error& failure) {
        if (!base || failure.kind() == Failure::data) throw;
        throw base->error(failure.what());
      }
    };
    Settings settings = base_settings();
    table_.read(settings, profile);
    return settings;
  }

  std::string kind_;
  std::string profile_;  // "physics profile", for messages
  std::string setting_;  // "physics constant"
  Format format_;
  std::string root_;
  SettingTable<Settings> table_;
};

}  // namespace evo
