#include "bindings/c/handles.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <shared_mutex>
#include <system_error>
#include <unordered_map>

#include "libevo/base/parallel.h"
#include "libevo/task/measure.h"

namespace evo::c {

namespace {

namespace fs = std::filesystem;

thread_local std::string last_error;

struct Handles {
  std::shared_mutex mutex;
  std::unordered_map<const void*, std::string_view> kinds;
};

// Never destroyed: handles may be freed while a program ends.
Handles& handles() {
  static auto* const all = new Handles;
  return *all;
}

}  // namespace

void remember(const std::string& message) { last_error = message; }

void enter(const void* handle, std::string_view kind) {
  const std::unique_lock lock(handles().mutex);
  handles().kinds[handle] = kind;
}

bool leave(const void* handle, std::string_view kind) {
  const std::unique_lock lock(handles().mutex);
  const auto found = handles().kinds.find(handle);
  if (found == handles().kinds.end() || found->second != kind) return false;
  handles().kinds.erase(found);
  return true;
}

void require(const void* handle, std::string_view kind) {
  if (handle == nullptr) throw error(Failure::usage, "a handle of {} is expected, not NULL", kind);
  const std::shared_lock lock(handles().mutex);
  const auto found = handles().kinds.find(handle);
  if (found == handles().kinds.end())
    throw error(Failure::usage, "a handle of {} is expected; this one was freed, or is none", kind);
  if (found->second != kind)
    throw error(Failure::usage, "a handle of {} is expected, not of {}", kind, found->second);
}

void check_count(std::size_t given, std::size_t expected, const char* what) {
  if (given != expected)
    throw error(Failure::usage, "{} {} are expected, not {}", expected, what, given);
}

void check_threads(std::int32_t threads) {
  if (threads < 1 || threads > most_threads)
    throw error(Failure::usage, "there may be 1 to {} threads, not {}", most_threads, threads);
}

std::string text_of(const char* text, const char* name) {
  if (text == nullptr) throw error(Failure::usage, "`{}` is NULL", name);
  return text;
}

std::vector<std::string> texts_of(const char* const* texts, std::size_t count, const char* name) {
  if (texts == nullptr && count > 0) throw error(Failure::usage, "`{}` is NULL", name);
  std::vector<std::string> list;
  for (std::size_t i = 0; i < count; ++i) list.push_back(text_of(texts[i], name));
  return list;
}

std::span<const Vec2> points_of(const double* positions, std::size_t count) {
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  return {reinterpret_cast<const Vec2*>(positions), count};
}

void check_size(std::size_t given, std::size_t present) {
  if (given == 0 || given > present)
    throw error(Failure::usage, "a struct of {} bytes is not of this version, in which it has {}",
                given, present);
}

const ModelObject& object_at(const Model& model, std::size_t index) {
  if (index >= model.objects().size())
    throw error(Failure::usage, "there is no object {}: the world has {}", index,
                model.objects().size());
  return model.objects()[index];
}

void orientations(const Model& model, const ModelObject& object, const double* given,
                  std::span<const Vec2> now, double* angles, std::size_t count) {
  const auto own = static_cast<std::size_t>(model.points());
  if (given == nullptr) check_count(count, now.size() / own, "angles");
  target(angles, "angles");
  const PointRange range{object.first_point, object.points};
  const InitialShape initial(range.of(model.initial_positions()));
  const auto moments = given == nullptr ? now : points_of(given, count * own);
  for (std::size_t i = 0; i < count; ++i)
    angles[i] = orientation(initial, range.of(moments.subspan(i * own, own)));
}

void give(std::string_view text, char** place, const char* name) {
  char*& to = target(place, name);  // before there is a copy that could be lost
  to = given(text);
}

void give(std::string_view state, void** bytes, std::size_t* count) {
  void*& to = target(bytes, "bytes");
  target(count, "count") = state.size();
  to = given(state);
}

void check_translation(const ModelObject& object, double x, double y) {
  if (object.is_static)
    throw error(Failure::usage, "object '{}' is terrain, which stays where it is", object.name);
  constexpr double largest = 1e6;
  if (!(std::abs(x) <= largest && std::abs(y) <= largest))
    throw error(Failure::usage, "object '{}' cannot be moved by ({}, {})", object.name, x, y);
}

char* given(std::string_view text) {
  auto* const copy = static_cast<char*>(std::malloc(text.size() + 1));
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, text.data(), text.size());
  copy[text.size()] = '\0';
  return copy;
}

Owner::Owner(int threads) : process_(threads > 1 ? getpid() : 0) {}

bool Owner::lost() const { return process_ != 0 && process_ != getpid(); }

void Owner::check() const {
  if (lost())
    throw Error(Failure::usage,
                "this was made with several threads, which a forked process does not have; make it "
                "anew, or with one thread");
}

DataFolders data_folders() {
  Dl_info self{};
  fs::path here;
  std::error_code failed;
  if (dladdr(reinterpret_cast<const void*>(&evo_version), &self) != 0 && self.dli_fname != nullptr)
    here = fs::canonical(self.dli_fname, failed).parent_path();
  return evo::data_folders(
      evo::data_root({here / EVO_DATA_FROM_LIBRARY, here / EVO_CHECKOUT_FROM_LIBRARY}));
}

}  // namespace evo::c

const char* evo_version() { return EVO_LIBRARY_VERSION; }
const char* evo_error() { return evo::c::last_error.c_str(); }
void evo_free(void* given) { std::free(given); }
