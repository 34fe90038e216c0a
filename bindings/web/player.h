// One robot in one task, played step by step: what the page asks of WebAssembly. Functions are
// plain C, so that nothing but numbers and addresses crosses the border. Texts are UTF-8 and end
// with 0; what a function gets, it copies. One that can fail returns how (evo::Failure, 0 for
// success); evo_answer() is then the error's line, otherwise what the function has to say.
#pragma once

#include <cstdint>

// Kept by the linker, and visible to the page.
#define EVO_EXPORTED __attribute__((used, visibility("default")))

extern "C" {

struct evo_player;

EVO_EXPORTED const char* evo_answer();
// A file that tasks and profiles may be found in: "tasks/Walker-v0.yaml".
EVO_EXPORTED void evo_give_file(const char* path, const char* text);

// A robot document in any form that the tools read as text; answers it as JSON on one line.
EVO_EXPORTED int evo_robot(const char* text);
// A random robot, and a mutated one: `rate` is the probability that a voxel is redrawn.
EVO_EXPORTED int evo_sample(int rows, int columns, std::uint32_t seed);
EVO_EXPORTED int evo_mutate(const char* robot, double rate, std::uint32_t seed);

// A task by name, as YAML, or as a world of the benchmark's design tool (JSON), which becomes
// the task that `evo-convert` would draft. Answers {"name", "description", "difficulty",
// "notes", "steps", "yaml", "observation": [words], "reward": [{"formula", "words", "weight",
// "when"}], "rules": [..], "folding"}.
EVO_EXPORTED int evo_task(const char* task);

// A robot placed in a task, before its first reset; nothing where that failed.
EVO_EXPORTED evo_player* evo_open(const char* task, const char* robot);
EVO_EXPORTED void evo_close(evo_player* player);
// Answers {"task", "steps", "points", "objects": [{"name", "first", "points", "static"}],
// "cells": [[object, letter, top left, top right, bottom left, bottom right]..], "follow":
// [objects], "terms": how many the reward has, "voxel": its length}.
EVO_EXPORTED int evo_describe(const evo_player* player);

// What drives the robot, JSON: {"kind": "wave", "amplitude", "period", "phase"} is `--actions
// sine:..`; else a policy as `evo-convert --to json` writes it.
EVO_EXPORTED int evo_control(evo_player* player, const char* controller);
// Begins the first episode of a seed, as evo-eval does. `draws`, or null: JSON of what the task
// would draw.
EVO_EXPORTED int evo_reset(evo_player* player, std::uint32_t seed, const char* draws);
// Control steps until `most` were taken or the episode is over.
EVO_EXPORTED int evo_step(evo_player* player, int most);

// Where the numbers are, until the player is closed.
EVO_EXPORTED const double* evo_positions(const evo_player* player);  // [points][2], raw units
// {return, last reward, steps, ended, folding, rules, terms..}: `ended` is 0 while the episode
// continues, 1 by a rule, 2 by the time limit, 3 with the sequence, 4 by self-folding, 5 by a rule
// that pays; the others are what each part of the reward has added to the return so far.
EVO_EXPORTED const double* evo_counts(const evo_player* player);

}  // extern "C"
