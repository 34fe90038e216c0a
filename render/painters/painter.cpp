#include "render/painters/painter.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
// After osmesa.h, which brings GL 1.
#include <GL/glext.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "libevo/base/error.h"
#include "render/painters/triangles.h"

namespace evo::render {
namespace {

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

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw error(Failure::work, "OSMesa cannot compile a shader: {}", log.data());
}

GLuint link_program(const char* fragment_shader) {
  const GLuint program = glCreateProgram();
  for (const GLuint shader :
       {compile(GL_VERTEX_SHADER, vertex_shader), compile(GL_FRAGMENT_SHADER, fragment_shader)}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);  // lives as long as the program
  }
  glLinkProgram(program);
  GLint done = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &done);
  if (done != GL_TRUE) throw Error(Failure::work, "OSMesa cannot link the shaders");
  return program;
}

void attribute(GLuint index, int count, GLenum type, bool normalised, std::size_t offset) {
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, count, type, normalised ? GL_TRUE : GL_FALSE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offset));  // NOLINT: GL's offsets
}

void describe_vertices() {
  static_assert(sizeof(Vertex) == 7 * sizeof(float) + 4);
  attribute(0, 2, GL_FLOAT, false, offsetof(Vertex, x));
  attribute(1, 2, GL_FLOAT, false, offsetof(Vertex, u));
  attribute(2, 3, GL_FLOAT, false, offsetof(Vertex, half_length));
  attribute(3, 4, GL_UNSIGNED_BYTE, true, offsetof(Vertex, color));
}

OSMesaContext create_context() {
  constexpr int attributes[] = {OSMESA_FORMAT,
                                OSMESA_RGBA,
                                OSMESA_PROFILE,
                                OSMESA_CORE_PROFILE,
                                OSMESA_CONTEXT_MAJOR_VERSION,
                                3,
                                OSMESA_CONTEXT_MINOR_VERSION,
                                3,
                                0};
  const OSMesaContext context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context == nullptr) throw Error(Failure::work, "OSMesa gives no OpenGL 3.3 core context");
  return context;
}

// The part of the layer's clip that lies in the tile, in GL's window
// coordinates (y upwards). False when nothing is left.
bool scissor(const Rect& clip, int tile_x, int tile_y, Size tile) {
  const int left = std::max(0, static_cast<int>(std::lround(clip.x)) - tile_x);
  const int top = std::max(0, static_cast<int>(std::lround(clip.y)) - tile_y);
  const int right =
      std::min(tile.width, static_cast<int>(std::lround(clip.x + clip.width)) - tile_x);
  const int low =
      std::min(tile.height, static_cast<int>(std::lround(clip.y + clip.height)) - tile_y);
  if (right <= left || low <= top) return false;
  glScissor(left, tile.height - low, right - left, low - top);
  return true;
}

}  // namespace

struct Painter::Gl {
  OSMesaContext context = create_context();
  Size tile;
  std::vector<std::uint8_t> pixels;  // of one tile
  // Opaque fills are most of the pixels and are painted with less work.
  struct Program {
    GLuint name = 0;
    GLint tile = -1;
  };
  Program fills, boxes;
  GLuint buffer = 0;

  Gl() = default;
  ~Gl() { OSMesaDestroyContext(context); }
  Gl(const Gl&) = delete;
  Gl& operator=(const Gl&) = delete;

  void resize(Size size) {
    if (size == tile) return;
    tile = size;
    pixels.resize(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) * 4);
    if (OSMesaMakeCurrent(context, pixels.data(), GL_UNSIGNED_BYTE, size.width, size.height) !=
        GL_TRUE)
      throw error(Failure::work, "OSMesa cannot draw {}x{} pixels", size.width, size.height);
    OSMesaPixelStore(OSMESA_Y_UP, 0);
    if (buffer == 0) set_up();
  }

  void set_up() {
    for (const auto& [program, shader] : {std::pair{&fills, fill_shader}, {&boxes, box_shader}})
      *program = {link_program(shader), 0};
    for (Program* program : {&fills, &boxes})
      program->tile = glGetUniformLocation(program->name, "tile");
    GLuint array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    describe_vertices();
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  }

  void upload(const std::vector<Vertex>& vertices) const {
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                 vertices.data(), GL_STREAM_DRAW);
  }

  void draw_tile(const Triangles& triangles, int x, int y) const {
    glViewport(0, 0, tile.width, tile.height);
    for (const Program& program : {fills, boxes}) {
      glUseProgram(program.name);
      glUniform4f(program.tile, static_cast<float>(x), static_cast<float>(y),
                  static_cast<float>(tile.width), static_cast<float>(tile.height));
    }
    glDisable(GL_SCISSOR_TEST);
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_SCISSOR_TEST);
    const auto& batches = triangles.batches;
    for (std::size_t k = 0; k < batches.size(); ++k) {
      const std::size_t first = batches[k].first_vertex;
      const std::size_t end =
          k + 1 < batches.size() ? batches[k + 1].first_vertex : triangles.vertices.size();
      if (!scissor(batches[k].clip, x, y, tile)) continue;
      const bool fill = batches[k].kind == Triangles::Kind::fill;
      glUseProgram(fill ? fills.name : boxes.name);
      fill ? glDisable(GL_BLEND) : glEnable(GL_BLEND);
      glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(end - first));
    }
    glFinish();
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

Painter::Painter() : gl_(std::make_unique<Gl>()) {}
Painter::~Painter() = default;

void Painter::paint(const Drawing& drawing, PixelTarget target) {
  check_size(target.size);
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
