#include "plugins/common/gl/gl_program.h"

#include "plugins/common/gl/gl.h"

static const char version[] = "#version 330\n";

static GLuint compile(GLenum kind, hk_gl_text text, char *log, size_t size) {
  const GLchar *source[] = {version, text.shared, text.text};
  GLint ok = 0;
  GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 3, source, NULL);
  glCompileShader(shader);
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  glGetShaderInfoLog(shader, (GLsizei)size, NULL, log);
  glDeleteShader(shader);
  return 0;
}

unsigned hk_gl_program(hk_gl_text vertex, hk_gl_text fragment, char *log, size_t size) {
  GLuint v = compile(GL_VERTEX_SHADER, vertex, log, size);
  GLuint f = v ? compile(GL_FRAGMENT_SHADER, fragment, log, size) : 0;
  GLuint program = 0;
  GLint ok = 0;
  if (f) {
    program = glCreateProgram();
    glAttachShader(program, v);
    glAttachShader(program, f);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    if (!ok) {
      glGetProgramInfoLog(program, (GLsizei)size, NULL, log);
      glDeleteProgram(program);
      program = 0;
    }
  }
  if (v) glDeleteShader(v);
  if (f) glDeleteShader(f);
  return program;
}
