// Which points may touch which cells: found once, kept while nothing has moved
// far (a neighbour list with a skin, as molecular dynamics uses them).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace evo {

// A corner of one surface cell against another surface cell.
struct ContactCandidate {
  std::uint32_t corner = 0;  // 4 * surface cell + Corner
  std::uint32_t cell = 0;
};

// In the order in which they push. The corner of candidate i is outside as long as the
// travel (contact.h) of its group is below due[i].
struct ContactCandidates {
  static constexpr std::size_t padding = 7;  // so that any 8 from one on can be read

  std::vector<ContactCandidate> all;
  std::vector<double> due;  // and padding

  std::uint32_t count() const { return static_cast<std::uint32_t>(all.size()); }
  void all_are_due() { due.assign(all.size() + padding, 0.0); }
};

// Candidates [first, last) between two objects, or of one with itself.
struct ContactGroup {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  std::array<std::uint32_t, 2> blocks{};  // of the plan; their number for static objects
  double due = 0.0;                       // no candidate is due before
};

// The box of a node of a BoundingTree at some travel of its block; at first, any box.
struct NodeBox {
  double width = 0.0;
  double height = 0.0;
  double travel = -HUGE_VAL;
  std::uint32_t look = 0;  // ContactLists::looks when it was found
};

// The lists of one environment. The positions that lists were found at are in its group's Rows.
struct ContactLists {
  // Within one moving object. Candidates of a pair of cells are next to each other: those
  // of corners of the one cell, then those of the other.
  struct Self {
    ContactCandidates candidates;
    ContactGroup group;  // all of them
    // Pairs of surface cells that count for self-folding and whose boxes may
    // overlap; empty when there are too few of them to fold the object.
    std::vector<std::array<std::uint32_t, 2>> folding;
    double folding_due = 0.0;  // no folding before twice the travel of the block is this
    bool valid = false;
    double due = 0.0;            // travel of the block at which the list may be too old
    std::vector<NodeBox> boxes;  // of the nodes of the object's tree
  };
  std::vector<Self> self;  // one per block of the plan
  // Between objects: groups in world order of pairs (i, j>i).
  ContactCandidates pairs;
  std::vector<ContactGroup> groups;
  std::vector<std::uint32_t> first_group;  // of each object i; objects + 1 entries
  bool pairs_valid = false;
  double pairs_due = 0.0;   // travel of the fastest block at which they may be too old
  std::uint32_t looks = 0;  // substeps with pushes, to tell boxes of now

  void invalidate() {
    pairs_valid = false;
    for (Self& s : self) s.valid = false;
  }
  // Travel is counted from 0 again: everything is due.
  void rewind() {
    looks = 0;
    pairs_due = 0.0;
    pairs.all_are_due();
    for (ContactGroup& g : groups) g.due = 0.0;
    for (Self& s : self) {
      s.due = s.group.due = s.folding_due = 0.0;
      s.candidates.all_are_due();
      std::fill(s.boxes.begin(), s.boxes.end(), NodeBox{});
    }
  }
};

}  // namespace evo
