// Profiles: named sets of settings as YAML, each starting from another one and
// giving only what differs. What physics and training profiles have in common.
#pragma once

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
struct ProfileKind {
  const char* what;  // "physics profile", for messages
  const Format& format;
  const char* subfolder;  // of the data folders
  // The profile that others start from unless they say `base`. Settings{} stands
  // for it where no folder has it.
  const char* root;
  const SettingTable<Settings>& table;
};

template <typename Settings>
Settings load_profile(const ProfileKind<Settings>& kind, const std::string& name_or_file,
                      const std::filesystem::path& folder, const DataFolders& folders,
                      int depth = 0);

// The profile in a mapping. A base that is a file is looked for in `folder`.
template <typename Settings>
Settings read_profile(const ProfileKind<Settings>& kind, const Node& node,
                      const std::filesystem::path& folder, const DataFolders& folders,
                      int depth = 0) {
  constexpr int longest_chain = 16;  // of profiles that start from one another
  std::vector<std::string> allowed{"format", "version", "name", "description", "base"};
  for (std::string& key : kind.table.outer_keys()) allowed.push_back(std::move(key));
  const Mapping profile(node, kind.what, allowed);
  check_format(profile.node(), kind.format);

  const auto base = profile.find("base");
  if (base && depth >= longest_chain)
    throw base->error("profiles start from one another in a circle");
  const auto base_settings = [&] {
    try {
      return load_profile(kind, base ? base->string() : kind.root, folder, folders, depth + 1);
    } catch (const Error& failure) {
      if (!base || failure.kind() == Failure::data) throw;
      throw base->error(failure.what());
    }
  };
  Settings settings = base_settings();
  kind.table.read(settings, profile);
  return settings;
}

// A profile by name, or by file (a name with '/' or ending in .yaml), which is
// looked for in `folder`. Throws Error(usage) for an unknown name,
// Error(no_input), Error(data).
template <typename Settings>
Settings load_profile(const ProfileKind<Settings>& kind, const std::string& name_or_file,
                      const std::filesystem::path& folder, const DataFolders& folders, int depth) {
  const auto load_file = [&](const std::filesystem::path& path, const DataFolders& bases) {
    return read_profile(kind, Node::yaml(read_file(path, largest_document), path.string()),
                        path.parent_path(), bases, depth);
  };
  const bool is_root = name_or_file == kind.root;
  if (is_file_name(name_or_file)) return load_file(folder / name_or_file, folders);
  // The root's file starts from what is built in, not from itself.
  if (const auto path = find_data_file(folders, kind.subfolder, name_or_file))
    return load_file(*path, is_root ? DataFolders{} : folders);
  if (is_root) return Settings{};
  std::vector<std::string> known = data_names(folders, kind.subfolder);
  if (known.empty()) known.emplace_back(kind.root);
  throw Error(Failure::usage,
              unknown_name(kind.what, name_or_file, known) + ", or a file (NAME.yaml)");
}

}  // namespace evo
