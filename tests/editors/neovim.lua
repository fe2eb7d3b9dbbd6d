-- What Neovim gets from the server for the file that is open: a table as JSON, into the file $FOUND.
local command = vim.fn.json_decode(vim.env.COMMAND)
local id = vim.lsp.start_client({ name = "mjcompose", cmd = command, root_dir = vim.fn.getcwd() })
vim.lsp.buf_attach_client(0, id)
local found = { completion = {}, actions = {} }

local function wait(holds)
  return vim.wait(30000, holds, 50)
end

local function ask(method, line, column, more)
  local params = { textDocument = vim.lsp.util.make_text_document_params(), position = { line = line, character = column } }
  local answers = vim.lsp.buf_request_sync(0, method, vim.tbl_extend("force", params, more or {}), 30000)
  return answers and answers[id] and answers[id].result
end

wait(function() return #vim.diagnostic.get(0) > 0 end)
local fault = vim.diagnostic.get(0)[1]
local line, column = fault.lnum, fault.col
found.fault = { line, column, fault.message }
local list = ask("textDocument/completion", line, column + 4)
for _, each in ipairs(list and (list.items or list) or {}) do table.insert(found.completion, each.label) end
local there = { start = { line = line, character = column }, ["end"] = { line = line, character = column + 1 } }
local given = fault.user_data and fault.user_data.lsp or {}
local actions = ask("textDocument/codeAction", line, column, {
  range = there,
  context = { diagnostics = { { range = there, message = fault.message, code = given.code or fault.code, source = fault.source } } },
})
for _, each in ipairs(actions or {}) do table.insert(found.actions, each.title) end
local hover = ask("textDocument/hover", line - 3, column)
found.hover = hover and hover.contents.value
local definition = ask("textDocument/definition", line - 3, column)
found.definition = definition and definition[1] and { definition[1].uri, definition[1].range.start.line }
vim.lsp.stop_client(id)
found.ended = wait(function() return vim.lsp.get_client_by_id(id) == nil end)
vim.fn.writefile({ vim.fn.json_encode(found) }, vim.env.FOUND)
vim.cmd("qa!")
