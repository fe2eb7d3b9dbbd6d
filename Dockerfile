# mjcompose and all that it can use; the folder with the recipes is /models:
#   docker build -t mjcompose .
#   docker run --rm -v "$PWD:/models" -u "$(id -u):$(id -g)" mjcompose build recipes/demo.yaml
FROM python:3.12-slim

# git for sources and `diff`, EGL for pictures without a screen
RUN apt-get update \
 && apt-get install --yes --no-install-recommends git libegl1 libgl1 \
 && rm -rf /var/lib/apt/lists/*

COPY . /source
RUN pip install --no-cache-dir --constraint /source/constraints.txt "/source[menagerie]" && rm -rf /source

# any user may run it: fetched models go to a volume or are lost with the container
ENV MUJOCO_GL=egl XDG_CACHE_HOME=/cache
RUN mkdir -m 1777 /cache && git config --system --add safe.directory '*'
WORKDIR /models
ENTRYPOINT ["mjcompose"]
CMD ["--help"]
