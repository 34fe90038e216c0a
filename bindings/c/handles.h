// What every function of evo/evo.h does: handles are looked up, failures become numbers
// and a text.
#pragma once

#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evo/evo.h"
#include "formats/io/data_folders.h"
#include "formats/robot/robot.h"
#include "formats/training/policy.h"
#include "libevo/base/error.h"
#include "libevo/control/settings.h"
#include "libevo/sim/model.h"
#include "libevo/task/spec.h"

namespace evo {

// What the policies that the library trains say they were made by: "libevo 0.1.0 (105ad79)", with
// the commit of the build.
const char* created_by();

}  // namespace evo

namespace evo::c {

void remember(const std::string& message);  // for evo_error()

// Runs the work of a function; what it throws is remembered.
template <typename Work>
int guarded(const Work& work) {
  try {
    work();
    return EVO_OK;
  } catch (const Error& failure) {
    remember(failure.what());
    return static_cast<int>(failure.kind());
  } catch (const std::bad_alloc&) {
    remember("out of memory");
  } catch (const std::exception& failure) {
    remember(failure.what());
  }
  return EVO_WORK;
}

// Which handles there are; each is of one kind, a type of evo/evo.h: `kind` of its struct.
void enter(const void* handle, std::string_view kind);
bool leave(const void* handle, std::string_view kind);  // whether it was one
void require(const void* handle, std::string_view kind);

// The object of a handle. Throws Error(usage) where it is none.
template <typename Handle>
Handle& object_of(Handle* handle) {
  require(handle, Handle::kind);
  return *handle;
}

template <typename T>
T& target(T* place, const char* name) {
  if (place == nullptr) throw error(Failure::usage, "`{}` is NULL", name);
  return *place;
}

std::string text_of(const char* text, const char* name);  // refuses NULL
std::vector<std::string> texts_of(const char* const* texts, std::size_t count, const char* name);

// Throws Error(usage) unless as many values are given as expected.
void check_count(std::size_t given, std::size_t expected, const char* what);

// Throws Error(usage) for less than 1 thread, or more than anybody means.
void check_threads(std::int32_t threads);

// Points that a caller gives as pairs of numbers.
std::span<const Vec2> points_of(const double* positions, std::size_t count);

// Throws Error(usage) where a world has no such object.
const ModelObject& object_at(const Model& model, std::size_t index);

// How far an object is turned at each of `count` moments: those that a caller gives, or, where
// `given` is NULL, those `now`, as many as there are. [count][points of the model].
void orientations(const Model& model, const ModelObject& object, const double* given,
                  std::span<const Vec2> now, double* angles, std::size_t count);

// Makes a handle of what `make` returns, a std::unique_ptr of its object.
template <typename Handle, typename Make>
int open(Handle** place, const Make& make) {
  return guarded([&] {
    Handle*& opened = target(place, "place of the handle");
    std::unique_ptr<Handle> made = make();
    enter(made.get(), Handle::kind);
    opened = made.release();
  });
}

template <typename Handle>
void close(Handle* handle) {
  if (handle == nullptr || !leave(handle, Handle::kind)) return;
  if constexpr (requires { handle->owner; })
    if (handle->owner.lost()) return;  // its destructor would wait for threads that are not here
  delete handle;
}

// Throws Error(usage) for a struct that a caller gives of a size that none ever had.
void check_size(std::size_t given, std::size_t present);

// Facts into the struct of a caller who may know fewer of them.
template <typename Facts>
void hand_over(const Facts& facts, Facts* place, std::size_t size) {
  target(place, "struct to be filled");
  check_size(size, sizeof(Facts));
  std::memcpy(place, &facts, size);
}

// The other way round: what a caller says, who may know less of it; NULL: nothing.
template <typename Given>
Given taken(const Given* given, std::size_t size) {
  Given whole{};
  if (given == nullptr) return whole;
  check_size(size, sizeof(Given));
  std::memcpy(&whole, given, size);
  return whole;
}

// A copy for evo_free().
char* given(std::string_view text);
// The same to where a caller wants it.
void give(std::string_view text, char** place, const char* name);
void give(std::string_view state, void** bytes, std::size_t* count);

// The process that threads were started in: a child forked from it has none of them.
class Owner {
 public:
  explicit Owner(int threads);
  bool lost() const;   // this process is such a child
  void check() const;  // throws Error(usage) if it is

 private:
  int process_ = 0;  // 0: no threads, so that any will do
};

std::unique_ptr<evo_task> task_of(TaskSpec spec);
std::unique_ptr<evo_robots> list_of(std::vector<Robot> robots);
std::unique_ptr<evo_policy> policy_of(PolicyFile file);

// The profile that a training names, changed as it says. Throws Error for what makes no sense.
TrainingSettings settings_of(const evo_training& training);

// Throws Error(usage) where an object cannot be moved by so much.
void check_translation(const ModelObject& object, double x, double y);

// Throws Error(usage) where the list has no such robot.
const Robot& robot_at(const evo_robots& robots, std::size_t index);

// Tasks and profiles as the tools find them: installed with this library, or in the checkout
// it was built in.
DataFolders data_folders();

// Draws `given`, or `now` where that is NULL. `task` says what is followed; it may be NULL. Throws
// Error(usage) for a view or a buffer that makes no sense.
void draw(const Model& model, std::span<const Vec2> now, const double* given, const TaskSpec* task,
          const evo_view* view, std::size_t size, std::uint8_t* pixels, std::size_t bytes);

// Changes what a handle stands for, in one thread at a time.
template <typename Handle, typename Work>
int change(Handle* handle, const Work& work) {
  return guarded([&] {
    Handle& object = object_of(handle);
    if constexpr (requires { object.owner; }) object.owner.check();
    const std::unique_lock changing(object.busy, std::try_to_lock);
    if (!changing)
      throw Error(Failure::usage, "another thread is changing what this handle stands for");
    work(object);
  });
}

}  // namespace evo::c

// What is behind the handles that several files need.
struct evo_task {
  static constexpr const char* kind = "evo_task";
  evo::TaskSpec spec;
  std::string yaml;     // of the whole task
  std::string physics;  // the same
};
struct evo_robots {
  static constexpr const char* kind = "evo_robots";
  std::vector<evo::Robot> list;
  std::vector<std::string> json;  // of each, its document
};
struct evo_policy {
  static constexpr const char* kind = "evo_policy";
  std::shared_ptr<evo::PolicyFile> file;  // shared with environments that it acts in
  std::vector<evo_curve_point> curve;
  std::mutex busy;
};
