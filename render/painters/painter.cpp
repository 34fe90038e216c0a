#include "render/painters/painter.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
// After osmesa.h, which brings GL 1.
#include <GL/glext.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "libevo/base/error.h"
#include "render/painters/raster.h"
#include "render/painters/triangles.h"

namespace evo::render {
namespace {

// ---- the library ---------------------------------------------------------------------

// What is called of OSMesa and of the OpenGL within it. They are looked up when something is to
// be painted: LLVM comes with them, which a tool that paints nothing need not load, and a wheel
// need not carry.
// clang-format off
#define EVO_GL_FUNCTIONS(X) \
  X(OSMesaCreateContextAttribs) X(OSMesaDestroyContext) X(OSMesaMakeCurrent) X(OSMesaPixelStore) \
  X(glAttachShader) X(glBindBuffer) X(glBindVertexArray) X(glBlendFunc) X(glBufferData) \
  X(glClear) X(glClearColor) X(glCompileShader) X(glCreateProgram) X(glCreateShader) \
  X(glDeleteShader) X(glDisable) X(glDrawArrays) X(glEnable) X(glEnableVertexAttribArray) \
  X(glFinish) X(glGenBuffers) X(glGenVertexArrays) X(glGetProgramiv) X(glGetShaderInfoLog) \
  X(glGetShaderiv) X(glGetUniformLocation) X(glLinkProgram) X(glScissor) X(glShaderSource) \
  X(glUniform4f) X(glUseProgram) X(glVertexAttribPointer) X(glViewport)
// clang-format on

struct Functions {
#define EVO_MEMBER(name) decltype(&::name) name = nullptr;  // NOLINT(bugprone-macro-parentheses)
  EVO_GL_FUNCTIONS(EVO_MEMBER)
#undef EVO_MEMBER
};

// Nothing where OSMesa is not installed.
const Functions* functions() {
  static const auto found = []() -> std::optional<Functions> {
    void* library = ::dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return std::nullopt;
    Functions all;
#define EVO_FIND(name)                                                      \
  all.name = reinterpret_cast<decltype(all.name)>(::dlsym(library, #name)); \
  if (all.name == nullptr) return std::nullopt;
    EVO_GL_FUNCTIONS(EVO_FIND)
#undef EVO_FIND
    return all;
  }();
  return found ? &*found : nullptr;
}

// ---- shaders -------------------------------------------------------------------------

constexpr int tile_side = 2048;  // pixels

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec2 position;   // pixels, y downwards
layout(location = 1) in vec2 local;      // in the frame of the box
layout(location = 2) in vec3 box;        // half length, half width, radius
layout(location = 3) in vec4 color;
uniform vec4 tile;                       // origin and size, pixels
out vec2 at;
flat out vec3 shape;
out vec4 paint;
void main() {
  vec2 share = (position - tile.xy) / tile.zw;
  gl_Position = vec4(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
  at = local;
  shape = box;
  paint = color;
}
)";

constexpr const char* fill_shader = R"(#version 330 core
in vec4 paint;
out vec4 pixel;
void main() { pixel = paint; }
)";

// The distance to a rounded box; inside is negative.
constexpr const char* box_shader = R"(#version 330 core
in vec2 at;
flat in vec3 shape;
in vec4 paint;
out vec4 pixel;
void main() {
  vec2 q = abs(at) - shape.xy + shape.z;
  float outside = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0) - shape.z;
  pixel = vec4(paint.rgb, paint.a * clamp(0.5 - outside, 0.0, 1.0));
}
)";

GLuint compile(const Functions& gl, GLenum kind, const char* source) {
  const GLuint shader = gl.glCreateShader(kind);
  gl.glShaderSource(shader, 1, &source, nullptr);
  gl.glCompileShader(shader);
  GLint done = 0;
  gl.glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  gl.glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw error(Failure::work, "OSMesa cannot compile a shader: {}", log.data());
}

GLuint link_program(const Functions& gl, const char* fragment_shader) {
  const GLuint program = gl.glCreateProgram();
  for (const GLuint shader : {compile(gl, GL_VERTEX_SHADER, vertex_shader),
                              compile(gl, GL_FRAGMENT_SHADER, fragment_shader)}) {
    gl.glAttachShader(program, shader);
    gl.glDeleteShader(shader);  // lives as long as the program
  }
  gl.glLinkProgram(program);
  GLint done = 0;
  gl.glGetProgramiv(program, GL_LINK_STATUS, &done);
  if (done != GL_TRUE) throw Error(Failure::work, "OSMesa cannot link the shaders");
  return program;
}

void attribute(const Functions& gl, GLuint index, int count, GLenum type, bool normalised,
               std::size_t offset) {
  gl.glEnableVertexAttribArray(index);
  gl.glVertexAttribPointer(index, count, type, normalised ? GL_TRUE : GL_FALSE, sizeof(Vertex),
                           reinterpret_cast<const void*>(offset));  // NOLINT: GL's offsets
}

void describe_vertices(const Functions& gl) {
  static_assert(sizeof(Vertex) == 7 * sizeof(float) + 4);
  attribute(gl, 0, 2, GL_FLOAT, false, offsetof(Vertex, x));
  attribute(gl, 1, 2, GL_FLOAT, false, offsetof(Vertex, u));
  attribute(gl, 2, 3, GL_FLOAT, false, offsetof(Vertex, half_length));
  attribute(gl, 3, 4, GL_UNSIGNED_BYTE, true, offsetof(Vertex, color));
}

OSMesaContext create_context(const Functions& gl) {
  constexpr int attributes[] = {OSMESA_FORMAT,
                                OSMESA_RGBA,
                                OSMESA_PROFILE,
                                OSMESA_CORE_PROFILE,
                                OSMESA_CONTEXT_MAJOR_VERSION,
                                3,
                                OSMESA_CONTEXT_MINOR_VERSION,
                                3,
                                0};
  const OSMesaContext context = gl.OSMesaCreateContextAttribs(attributes, nullptr);
  if (context == nullptr) throw Error(Failure::work, "OSMesa gives no OpenGL 3.3 core context");
  return context;
}

// The part of the layer's clip that lies in the tile, in GL's window
// coordinates (y upwards). False when nothing is left.
bool scissor(const Functions& gl, const Rect& clip, int tile_x, int tile_y, Size tile) {
  const int left = std::max(0, static_cast<int>(std::lround(clip.x)) - tile_x);
  const int top = std::max(0, static_cast<int>(std::lround(clip.y)) - tile_y);
  const int right =
      std::min(tile.width, static_cast<int>(std::lround(clip.x + clip.width)) - tile_x);
  const int low =
      std::min(tile.height, static_cast<int>(std::lround(clip.y + clip.height)) - tile_y);
  if (right <= left || low <= top) return false;
  gl.glScissor(left, tile.height - low, right - left, low - top);
  return true;
}

}  // namespace

struct Painter::Gl {
  const Functions& gl;
  OSMesaContext context = create_context(gl);
  Size tile;
  std::vector<std::uint8_t> pixels;  // of one tile
  // Opaque fills are most of the pixels and are painted with less work.
  struct Program {
    GLuint name = 0;
    GLint tile = -1;
  };
  Program fills, boxes;
  GLuint buffer = 0;

  explicit Gl(const Functions& functions) : gl(functions) {}
  ~Gl() { gl.OSMesaDestroyContext(context); }
  Gl(const Gl&) = delete;
  Gl& operator=(const Gl&) = delete;

  void resize(Size size) {
    if (size == tile) return;
    tile = size;
    pixels.resize(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) * 4);
    if (gl.OSMesaMakeCurrent(context, pixels.data(), GL_UNSIGNED_BYTE, size.width, size.height) !=
        GL_TRUE)
      throw error(Failure::work, "OSMesa cannot draw {}x{} pixels", size.width, size.height);
    gl.OSMesaPixelStore(OSMESA_Y_UP, 0);
    if (buffer == 0) set_up();
  }

  void set_up() {
    for (const auto& [program, shader] : {std::pair{&fills, fill_shader}, {&boxes, box_shader}})
      *program = {link_program(gl, shader), 0};
    for (Program* program : {&fills, &boxes})
      program->tile = gl.glGetUniformLocation(program->name, "tile");
    GLuint array = 0;
    gl.glGenVertexArrays(1, &array);
    gl.glBindVertexArray(array);
    gl.glGenBuffers(1, &buffer);
    gl.glBindBuffer(GL_ARRAY_BUFFER, buffer);
    describe_vertices(gl);
    gl.glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  }

  void upload(const std::vector<Vertex>& vertices) const {
    gl.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                    vertices.data(), GL_STREAM_DRAW);
  }

  void draw_tile(const Triangles& triangles, int x, int y) const {
    gl.glViewport(0, 0, tile.width, tile.height);
    for (const Program& program : {fills, boxes}) {
      gl.glUseProgram(program.name);
      gl.glUniform4f(program.tile, static_cast<float>(x), static_cast<float>(y),
                     static_cast<float>(tile.width), static_cast<float>(tile.height));
    }
    gl.glDisable(GL_SCISSOR_TEST);
    gl.glClearColor(1, 1, 1, 1);
    gl.glClear(GL_COLOR_BUFFER_BIT);
    gl.glEnable(GL_SCISSOR_TEST);
    const auto& batches = triangles.batches;
    for (std::size_t k = 0; k < batches.size(); ++k) {
      const std::size_t first = batches[k].first_vertex;
      const std::size_t end =
          k + 1 < batches.size() ? batches[k + 1].first_vertex : triangles.vertices.size();
      if (!scissor(gl, batches[k].clip, x, y, tile)) continue;
      const bool fill = batches[k].kind == Triangles::Kind::fill;
      gl.glUseProgram(fill ? fills.name : boxes.name);
      fill ? gl.glDisable(GL_BLEND) : gl.glEnable(GL_BLEND);
      gl.glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(end - first));
    }
    gl.glFinish();
  }

  void copy_tile(PixelTarget target, int x, int y) const {
    const int columns = std::min(tile.width, target.size.width - x);
    const int rows = std::min(tile.height, target.size.height - y);
    for (int row = 0; row < rows; ++row) {
      const auto from = static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width) * 4;
      const auto to =
          (static_cast<std::size_t>(y + row) * static_cast<std::size_t>(target.size.width) +
           static_cast<std::size_t>(x)) *
          4;
      std::memcpy(&target.rgba[to], &pixels[from], static_cast<std::size_t>(columns) * 4);
    }
  }
};

Painter::Painter() {
  if (const Functions* gl = functions()) gl_ = std::make_unique<Gl>(*gl);
}
Painter::~Painter() = default;

void Painter::paint(const Drawing& drawing, PixelTarget target) {
  check_size(target.size);
  if (!gl_) return rasterise(drawing, target);
  gl_->resize({std::min(tile_side, target.size.width), std::min(tile_side, target.size.height)});
  const Triangles triangles = triangulate(drawing);
  gl_->upload(triangles.vertices);
  for (int y = 0; y < target.size.height; y += gl_->tile.height) {
    for (int x = 0; x < target.size.width; x += gl_->tile.width) {
      gl_->draw_tile(triangles, x, y);
      gl_->copy_tile(target, x, y);
    }
  }
  for (const Text& text : drawing.texts()) typesetter_.draw(text, target);
  for (std::size_t k = 3; k < target.rgba.size(); k += 4) target.rgba[k] = 255;
}

}  // namespace evo::render
